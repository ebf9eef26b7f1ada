// SPDX-License-Identifier: Apache-2.0
#include "app/view/body.hpp"

#include <algorithm>
#include <utility>

#include "app/view/camera.hpp"

namespace sunder::app {
namespace {

/// A history is kept from before anything is done.
Simulation& with_history(Simulation& simulation, const Simulation::MakeBackend& make,
                         bool goes_back) {
  if (goes_back) simulation.keep_history(make);
  return simulation;
}

std::string key_of(const std::string& change) { return change.substr(0, change.find('=')); }

}  // namespace

std::vector<std::string> changed(std::vector<std::string> before,
                                 const std::vector<std::string>& then) {
  for (const std::string& change : then) {
    std::erase_if(before, [&](const std::string& old) { return key_of(old) == key_of(change); });
    before.push_back(change);
  }
  return before;
}

Body::Body(const std::shared_ptr<const Problem>& problem, const Simulation::MakeBackend& make,
           bool goes_back, std::shared_ptr<view::SharedPoints> shared)
    : simulation(problem, make()),
      hand(with_history(simulation, make, goes_back), goes_back),
      showing(simulation, std::move(shared)),
      points(shown_points(*problem)) {}

void Body::step() {
  if (simulation.done()) return;
  const auto number = static_cast<std::size_t>(simulation.steps_done());
  const StepReport report = hand.step();
  reports_.resize(number);
  reports_.push_back(report);
}

const StepReport* Body::report() const {
  const auto done = static_cast<std::size_t>(simulation.steps_done());
  return done > 0 && done <= reports_.size() ? &reports_[done - 1] : nullptr;
}

bool same_base(const Body& a, const Body& b) {
  const Problem &one = a.simulation.problem(), &other = b.simulation.problem();
  for (const Body* body : {&a, &b}) {
    const Problem& problem = body->simulation.problem();
    if (problem.finite() || problem.moves() || problem.fibrous()) return false;
    if (body->simulation.backend().info().backend != "cpu") return false;
  }
  if (a.simulation.backend().info().route != b.simulation.backend().info().route) return false;
  if (one.mesh().tets != other.mesh().tets || one.mesh().nodes != other.mesh().nodes) return false;
  for (Index e = 0; e < one.tet_count(); ++e) {
    const Material &was = one.material(e), &is = other.material(e);
    if (was.young != is.young || was.poisson != is.poisson) return false;
  }
  return std::ranges::equal(one.dofs(), other.dofs());
}

}  // namespace sunder::app
