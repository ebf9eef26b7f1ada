// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of a body by at run time, and pushes it with.
#include <algorithm>
#include <cmath>

#include "body/pieces.hpp"
#include "frame/act.hpp"
#include "frame/history.hpp"
#include "frame/loads.hpp"
#include "frame/quaternion.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

[[noreturn]] void refuse_node(Index node, const std::string& what, const std::string& why) {
  throw UsageError("node " + std::to_string(node) + " cannot be " + what + ": " + why);
}

void check_nodes(std::span<const Index> nodes, const Problem& problem, const std::string& what) {
  if (nodes.empty()) throw UsageError("there are no nodes to be " + what);
  std::vector<Index> sorted(nodes.begin(), nodes.end());
  std::ranges::sort(sorted);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const Index n = sorted[i];
    if (n < 0 || n >= problem.node_count())
      refuse_node(n, what, "the mesh has none of that number");
    if (i > 0 && n == sorted[i - 1]) refuse_node(n, what, "it is named twice");
  }
}

}  // namespace

void Simulation::require_grasp() const {
  require_damage("grasped");
  if (const std::string why = backend_->why_no_grasp(); !why.empty()) {
    throw UsageError("nothing can be grasped: " + why);
  }
}

/// Why a node cannot be gripped; empty: it can.
std::string Simulation::why_not(Index node) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (problem_->dof(node, axis) == kNone) {
      return "a support holds it, or it belongs to nothing that moves";
    }
  }
  const auto gripped = backend_->gripped_dofs();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::ranges::find(gripped, problem_->dof(node, axis)) != gripped.end()) {
      return "another grip holds it";
    }
  }
  if (looks_ > 0 && loose_->isolated(node)) return "all elements around it are gone";
  return {};
}

std::vector<Vec3> Simulation::displacement_of(std::span<const Index> nodes) const {
  std::vector<Vec3> u(nodes.size(), Vec3::Zero());
  if (now_.solved) backend_->read_displacement(nodes, u);
  return u;
}

int Simulation::grasp(std::span<const Index> nodes, bool rigid) {
  require_grasp();
  check_nodes(nodes, *problem_, "grasped");
  const std::vector<Vec3> u = displacement_of(nodes);
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    centre += (problem_->mesh().nodes[static_cast<std::size_t>(nodes[i])] + u[i]) /
              static_cast<double>(nodes.size());
  }
  return take_hold({{nodes.begin(), nodes.end()}, rigid, centre});
}

int Simulation::grasp(const Vec3& near, double radius, bool rigid) {
  require_grasp();
  if (!near.allFinite()) throw UsageError("the place of a grip must be finite");
  if (!(radius > 0) || !std::isfinite(radius)) {
    throw UsageError("the radius of a grip must be finite and above 0 mm");
  }
  const std::vector<Vec3> u = displacement();
  std::vector<Index> nodes;
  for (Index n = 0; n < problem_->node_count(); ++n) {
    const Vec3 place =
        problem_->mesh().nodes[static_cast<std::size_t>(n)] + u[static_cast<std::size_t>(n)];
    if ((place - near).norm() <= radius && why_not(n).empty()) nodes.push_back(n);
  }
  if (nodes.empty()) {
    throw UsageError("no node that could be grasped lies within " + in_digits(radius) +
                     " mm of that place");
  }
  return take_hold({std::move(nodes), rigid, near});
}

int Simulation::take_hold(const action::Grasp& what) {
  require_grasp();
  check_nodes(what.nodes, *problem_, "grasped");
  for (Index n : what.nodes) {
    if (const std::string why = why_not(n); !why.empty()) refuse_node(n, "grasped", why);
  }
  int id = kNone;
  act({what}, [&](Action&) {
    Tool tool;
    tool.holds = true;
    tool.rigid = what.rigid;
    tool.nodes = what.nodes;
    tool.centre = what.centre;
    tool.moved = displacement_of(what.nodes);
    for (std::size_t i = 0; i < what.nodes.size(); ++i) {
      tool.arms.push_back(problem_->mesh().nodes[static_cast<std::size_t>(what.nodes[i])] +
                          tool.moved[i] - what.centre);
    }
    const std::vector<Index> dofs = dofs_of(tool, *problem_);
    id = loads_->take(std::move(tool));
    backend_->grasp(dofs);
    describe_grips();
    follow_grips(loose_->pieces() > 0);
  });
  return id;
}

/// What holds pieces has changed; `looks`: some may be loose now, or no longer.
void Simulation::follow_grips(bool looks) {
  loose_->hold(loads_->held_unknowns(), loads_->held_nodes());
  criterion_->hold(loads_->held_unknowns());
  if (looks) find_loose();
}

const Tool& Simulation::tool(int id, bool holds) const {
  const int scene = static_cast<int>(problem_->scene().instruments.size());
  const char* const what = holds ? "grip" : "push";
  if (id >= 0 && id < scene) {
    throw UsageError("instrument " + std::to_string(id) + " is the scene's own, no " + what +
                     " of a host: it is driven and turned");
  }
  const Tool* found = loads_->tool(id);
  if (!found || found->holds != holds) {
    throw UsageError("there is no " + std::string(what) + " " + std::to_string(id) +
                     (found ? ": that is a " + std::string(holds ? "push" : "grip")
                      : id >= scene && id < loads_->next_tool() ? ": it has been let go"
                                                                : ""));
  }
  return *found;
}

void Simulation::pose(int id, const Pose& pose) {
  const Tool& of = tool(id, true);
  if (!pose.position.allFinite()) throw UsageError("a grip's place must be finite");
  if (!names_a_turn(pose.quaternion)) {
    throw UsageError(
        "a grip's quaternion must be finite and of a length above 0: x, y, z, w, of no turn 0, 0, "
        "0, 1");
  }
  const Mat3 turn = turn_by(pose.quaternion);
  if (!of.rigid && !turn.isZero(0)) {
    throw UsageError("grip " + std::to_string(id) +
                     " holds points, which do not turn; grasp them rigidly");
  }
  act({Action::Pose{id, pose.position, pose.quaternion}}, [&](Action&) {
    Tool& now = *loads_->tool(id);
    now.shift = pose.position - now.centre;
    now.turn = turn;
  });
}

Vec3 Simulation::centre_of(int id) const {
  const Tool& of = tool(id, true);
  return of.centre + of.shift;
}

std::span<const Index> Simulation::held_nodes(int id) const { return tool(id, true).nodes; }

Wrench Simulation::wrench(int id) const {
  const Tool& of = tool(id, true);
  Wrench felt;
  if (!now_.solved) return felt;
  std::vector<double> forces(backend_->gripped_dofs().size());
  backend_->read_reactions(forces);
  for (std::size_t n = 0; n < of.nodes.size(); ++n) {
    const Vec3 force(&forces[of.first + 3 * n]);
    felt.force += force;
    felt.torque += Vec3(of.arms[n] + of.turn_at_load * of.arms[n]).cross(force);
  }
  return felt;
}

void Simulation::release(int id) {
  if (id >= 0 && id < static_cast<int>(problem_->scene().instruments.size())) {
    release_own(static_cast<std::size_t>(id));
    return;
  }
  static_cast<void>(tool(id, true));
  act({Action::Release{id}}, [&](Action&) {
    const std::vector<Index> dofs = dofs_of(tool(id, true), *problem_);
    if (haptics_) haptics_->let_go(id);
    loads_->drop(id);
    backend_->release(dofs);
    describe_grips();
    follow_grips(now_.gone > 0);
  });
}

/// A grip of the scene.
void Simulation::release_own(std::size_t instrument) {
  check_release(instrument);
  act({Action::Release{static_cast<int>(instrument)}}, [&](Action&) {
    const std::vector<Index> dofs = loads_->let_go(instrument);
    if (haptics_) haptics_->let_go(own_grips());
    backend_->release(dofs);
    describe_grips();
    follow_grips(now_.gone > 0);
  });
}

void Simulation::check_release(std::size_t instrument) const {
  const std::string name = "instrument " + std::to_string(instrument);
  const Instrument& of = problem_->scene().instruments[instrument];
  if (!std::holds_alternative<Grip>(of.action)) {
    throw UsageError(name + " cannot let go: it holds nothing; drive its force to 0");
  }
  if (loads_->has_let_go(instrument)) throw UsageError(name + " has let go already");
  const std::string cannot = name + " cannot let go: ";
  if (!backend_->needs().damage) {
    throw UsageError(cannot +
                     "the scene has neither fracture nor removals, and was not told that it is "
                     "live before the simulation was made");
  }
  if (const std::string why = backend_->why_no_grasp(); !why.empty())
    throw UsageError(cannot + why);
  const auto anchored = problem_->anchored_dofs();
  // Where a split crack has come by, the body would have parted further had the node been free.
  std::vector<Index> of_cracks;
  for (const CrackFace& face : criterion_->faces()) {
    of_cracks.insert(of_cracks.end(), face.left.begin(), face.left.end());
    of_cracks.insert(of_cracks.end(), face.right.begin(), face.right.end());
  }
  for (std::size_t g = 0; g < loads_->gripped().size(); ++g) {
    const Loads::Gripped& held = loads_->gripped()[g];
    if (held.instrument != instrument) continue;
    if (std::ranges::find(anchored, loads_->held_unknowns()[g]) != anchored.end()) {
      throw UsageError(cannot + "the body with node " + std::to_string(held.node) +
                       " is held by grips of the scene alone, and in statics it would have no "
                       "place; hold it with [[fixed]]");
    }
    if (std::ranges::find(of_cracks, held.node) != of_cracks.end()) {
      throw UsageError(cannot + "a crack of split nodes has reached node " +
                       std::to_string(held.node) + ", which it holds");
    }
  }
}

void Simulation::check_push(std::span<const Index> nodes, const Vec3& force) const {
  if (!force.allFinite()) throw UsageError("a push must be finite");
  check_nodes(nodes, *problem_, "pushed");
  for (Index n : nodes) {
    bool free = false;
    for (int axis = 0; axis < 3; ++axis) free = free || problem_->dof(n, axis) != kNone;
    if (!free) refuse_node(n, "pushed", "a support holds it, or it belongs to nothing that moves");
  }
}

int Simulation::push(std::span<const Index> nodes, const Vec3& force) {
  check_push(nodes, force);
  int id = kNone;
  act({Action::Push{{nodes.begin(), nodes.end()}, force}}, [&](Action&) {
    Tool tool;
    tool.nodes.assign(nodes.begin(), nodes.end());
    tool.force = force;
    id = loads_->take(std::move(tool));
  });
  return id;
}

void Simulation::move(int id, std::span<const Index> nodes, const Vec3& force) {
  static_cast<void>(tool(id, false));
  check_push(nodes, force);
  act({Action::Move{id, {nodes.begin(), nodes.end()}, force}},
      [&](Action&) { loads_->move(id, nodes, force); });
}

void Simulation::drop(int id) {
  static_cast<void>(tool(id, false));
  act({Action::Drop{id}}, [&](Action&) { loads_->drop(id); });
}

}  // namespace sunder
