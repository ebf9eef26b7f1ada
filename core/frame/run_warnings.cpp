// SPDX-License-Identifier: Apache-2.0
// What a run has to warn of, and the steps in which that was.
#include <iomanip>
#include <sstream>

#include "fracture/finding.hpp"
#include "sunder/simulation.hpp"
#include "sunder/words.hpp"

namespace sunder {

void Simulation::Beyond::add(int step, double value) {
  steps.add(step);
  if (!(value > most)) return;
  most = value;
  at = step;
}

void Simulation::Steps::add(int step) {
  if (step == last) return;
  if (count++ == 0) first = step;
  last = step;
}

std::string Simulation::Steps::sentence(const std::string& what) const {
  if (count == 1) return "step " + std::to_string(first) + " " + what;
  return std::to_string(count) + " steps between " + std::to_string(first) + " and " +
         std::to_string(last) + " " + what;
}

void Simulation::note(const Finding& finding) {
  if (std::ranges::find(findings_, finding) == findings_.end()) findings_.push_back(finding);
}

std::vector<std::string> Simulation::warnings() const {
  std::vector<std::string> all = problem_->warnings();
  for (std::string& words : backend_->warnings()) all.push_back(std::move(words));
  for (const Finding& found : findings_) {  // instruments may have the same name
    std::string words = sentence(found, problem_->scene());
    if (std::ranges::find(all, words) == all.end()) all.push_back(std::move(words));
  }
  if (now_.capped.count > 0) {
    all.push_back(now_.capped.sentence("ended at fracture.max_events = " +
                                       count_of(problem_->scene().fracture.max_events, "event") +
                                       "; more may have been ready to break"));
  }
  if (now_.cut_short.count > 0) {
    all.push_back(now_.cut_short.sentence(
        "ended at dynamics.max_iterations = " +
        std::to_string(problem_->scene().dynamics->max_iterations) +
        ": the stress error there is only estimated, not under solver.tolerance"));
  }
  if (now_.polished.count > 0) {
    all.push_back(now_.polished.sentence("had a frame over the tolerance, which was polished"));
  }
  if (now_.unfinished.count > 0) {
    all.push_back(now_.unfinished.sentence(
        "ended before the body was at rest: nothing was decided there, the next step went on from "
        "it"));
  }
  if (now_.out_of_time.count > 0) {
    all.push_back(now_.out_of_time.sentence(
        "ended by time, before nothing broke any more: the bits of this run depend on the clock"));
  }
  add_deformation_warnings(all);
  if (problem_->moves()) {
    if (now_.loose_pieces > 0) {
      all.push_back(count_of(static_cast<long long>(now_.loose_pieces), "piece") + " with " +
                    count_of(static_cast<long long>(now_.loose_elements), "element") +
                    (now_.loose_pieces == 1 ? " moves on by itself" : " move on by themselves") +
                    " (since step " + std::to_string(now_.loose_pieces_step) +
                    "): no support and no grip holds " + (now_.loose_pieces == 1 ? "it" : "them"));
    }
    return all;
  }
  const std::string so = problem_->finite() || problem_->fibrous() ? " displacement stays as it was"
                                                                   : " displacement has no meaning";
  if (now_.loose_nodes > 0) {
    all.push_back(count_of(static_cast<long long>(now_.loose_nodes), "node is", "nodes are") +
                  " held by destroyed elements only (since step " +
                  std::to_string(now_.loose_nodes_step) + "); " +
                  (now_.loose_nodes == 1 ? "its" : "their") + so);
  }
  if (now_.loose_pieces > 0) {
    const bool one = now_.loose_pieces == 1;
    all.push_back(count_of(static_cast<long long>(now_.loose_pieces), "piece") + " with " +
                  count_of(static_cast<long long>(now_.loose_elements), "element") +
                  (one ? " is" : " are") + " cut off (since step " +
                  std::to_string(now_.loose_pieces_step) + "); only destroyed elements hold " +
                  (one ? "it and its" : "them and their") + so);
  }
  return all;
}

void Simulation::add_deformation_warnings(std::vector<std::string>& all) const {
  const auto add = [&](const Beyond& beyond, const std::string& what, const std::string& most,
                       const std::string& so) {
    if (beyond.steps.count == 0) return;
    const bool part = backend_->info().route == "condensed";
    all.push_back(beyond.steps.sentence(
        what + " (most in step " + std::to_string(beyond.at) + ": " + most +
        (part ? ", in the region that a frame computes" : "") + "): " + so + " (docs/limits.md)"));
  };
  const auto three = [](double value) {
    std::ostringstream out;
    out << std::setprecision(3) << value;
    return out.str();
  };
  const std::string verb = " live tissue by over ";
  add(now_.strained, "strained" + verb + three(100 * kSmallStrain) + " %",
      three(100 * now_.strained.most) + " %",
      "the law is linear, for small strains, and the figures there are no longer those of tissue");
  add(now_.turned, "turned" + verb + three(kSmallRotationDeg) + " deg",
      three(now_.turned.most) + " deg", "the theory of small strains takes a rotation for strain");
  add(now_.inverted, "turned live elements inside out",
      three(now_.inverted.most) + (now_.inverted.most > 1 ? " elements" : " element"),
      "with det(I + grad u) <= 0 no body has that shape");
}

}  // namespace sunder
