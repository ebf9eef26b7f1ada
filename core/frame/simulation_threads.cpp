// SPDX-License-Identifier: Apache-2.0
// What other threads read beside the steps: forces of the grips, fields of the last finished frame.
#include <algorithm>
#include <utility>

#include "frame/loads.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder {

std::shared_ptr<InstrumentForces> Simulation::grip_forces() {
  if (haptics_) return haptics_;
  haptics_ = backend_->instrument_forces();
  if (!haptics_) return nullptr;
  describe_grips();
  haptics_->label(now_.next_step - 1);
  if (now_.solved) {
    haptics_->publish_again();
  } else {
    haptics_->withdraw();  // a solution under no load, of warm_up()
  }
  return haptics_;
}

void Simulation::describe_grips() {
  if (!haptics_) return;
  std::vector<HeldGrip> grips;
  for (const Tool& tool : loads_->tools()) {
    if (!tool.holds) continue;
    grips.push_back({tool.id, tool.rigid, tool.first, tool.centre, tool.moved, tool.arms});
  }
  haptics_->describe(std::move(grips), own_grips());
}

/// Places of the unknowns that the scene's grips hold among all of Problem::gripped_dofs().
std::vector<Index> Simulation::own_grips() const {
  std::vector<Index> places;
  const auto gripped = problem_->gripped_dofs();
  for (Index d : loads_->held_unknowns()) {
    places.push_back(static_cast<Index>(std::ranges::lower_bound(gripped, d) - gripped.begin()));
  }
  return places;
}

/// After going back or forth.
void Simulation::arrive() {
  finish_frame();
  if (!haptics_) return;
  describe_grips();
  haptics_->label(now_.next_step - 1);
  if (!now_.solved) haptics_->withdraw();
}

std::shared_ptr<FinishedFrames> Simulation::finished_frames(FinishedFields fields) {
  for (Index n : fields.nodes) {
    if (n < 0 || n >= problem_->node_count()) {
      throw UsageError("node " + std::to_string(n) +
                       " cannot be read: the mesh has none of that "
                       "number");
    }
  }
  if ((fields.stress || fields.yield_ratio) && !backend_->needs().stress) {
    throw UsageError("stress was left out of this simulation");
  }
  if (frames_) frames_->end();
  frames_ = std::make_shared<FinishedFrames>(std::move(fields));
  finish_frame();
  return frames_;
}

/// Where nobody reads frames, nothing.
void Simulation::finish_frame() {
  if (!frames_ || replaying()) return;
  const FinishedFields& wanted = frames_->fields();
  FinishedFrame& frame = frames_->next();
  frame.step = now_.next_step - 1;
  frame.node_count = backend_->node_count();
  if (wanted.displacement) {
    const std::size_t count =
        wanted.nodes.empty() ? static_cast<std::size_t>(frame.node_count) : wanted.nodes.size();
    frame.displacement.assign(count, Vec3::Zero());
    if (now_.solved && wanted.nodes.empty()) {
      backend_->read_displacement({frame.displacement.front().data(), 3 * count});
    } else if (now_.solved) {
      backend_->read_displacement(wanted.nodes, frame.displacement);
    }
  }
  if (wanted.destroyed) {
    frame.destroyed.assign(backend_->destroyed().begin(), backend_->destroyed().end());
  }
  const std::size_t elements = problem_->mesh().tets.size();
  if (wanted.stress || wanted.yield_ratio) {
    frame.stress.assign(elements, Voigt::Zero());
    if (now_.solved) backend_->read_stress(frame.stress);
  }
  if (wanted.yield_ratio) {
    const YieldMeasure measure = strength_measure(problem_->scene().fracture);
    const auto destroyed = backend_->destroyed();
    frame.yield_ratio.assign(elements, 0.0);
    for (Index e = 0; e < problem_->tet_count(); ++e) {
      const auto at = static_cast<std::size_t>(e);
      if (!problem_->breakable(e) || destroyed[at]) continue;
      frame.yield_ratio[at] = problem_->yield_ratio(e, frame.stress[at], measure);
    }
  }
  frames_->hand_over();
}

}  // namespace sunder
