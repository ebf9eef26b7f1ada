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
  if (capped_.count > 0) {
    all.push_back(capped_.sentence("ended at fracture.max_events = " +
                                   count_of(problem_->scene().fracture.max_events, "event") +
                                   "; more may have been ready to break"));
  }
  if (cut_short_.count > 0) {
    all.push_back(cut_short_.sentence(
        "ended at dynamics.max_iterations = " +
        std::to_string(problem_->scene().dynamics->max_iterations) +
        ": the stress error there is only estimated, not under solver.tolerance"));
  }
  if (polished_.count > 0) {
    all.push_back(polished_.sentence("had a frame over the tolerance, which was polished"));
  }
  if (unfinished_.count > 0) {
    all.push_back(unfinished_.sentence(
        "ended before the body was at rest: nothing was decided there, the next step went on from "
        "it"));
  }
  add_deformation_warnings(all);
  if (problem_->moves()) {
    if (loose_pieces_ > 0) {
      all.push_back(count_of(static_cast<long long>(loose_pieces_), "piece") + " with " +
                    count_of(static_cast<long long>(loose_elements_), "element") +
                    (loose_pieces_ == 1 ? " moves on by itself" : " move on by themselves") +
                    " (since step " + std::to_string(loose_pieces_step_) +
                    "): no support and no grip holds " + (loose_pieces_ == 1 ? "it" : "them"));
    }
    return all;
  }
  const std::string so =
      problem_->finite() ? " displacement stays as it was" : " displacement has no meaning";
  if (loose_nodes_ > 0) {
    all.push_back(count_of(static_cast<long long>(loose_nodes_), "node is", "nodes are") +
                  " held by destroyed elements only (since step " +
                  std::to_string(loose_nodes_step_) + "); " +
                  (loose_nodes_ == 1 ? "its" : "their") + so);
  }
  if (loose_pieces_ > 0) {
    const bool one = loose_pieces_ == 1;
    all.push_back(count_of(static_cast<long long>(loose_pieces_), "piece") + " with " +
                  count_of(static_cast<long long>(loose_elements_), "element") +
                  (one ? " is" : " are") + " cut off (since step " +
                  std::to_string(loose_pieces_step_) + "); only destroyed elements hold " +
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
  add(strained_, "strained" + verb + three(100 * kSmallStrain) + " %",
      three(100 * strained_.most) + " %",
      "the law is linear, for small strains, and the figures there are no longer those of tissue");
  add(turned_, "turned" + verb + three(kSmallRotationDeg) + " deg", three(turned_.most) + " deg",
      "the theory of small strains takes a rotation for strain");
  add(inverted_, "turned live elements inside out",
      three(inverted_.most) + (inverted_.most > 1 ? " elements" : " element"),
      "with det(I + grad u) <= 0 no body has that shape");
}

}  // namespace sunder
