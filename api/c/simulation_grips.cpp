// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of a body by, and pushes it with, while the simulation runs.
#include <algorithm>

#include "c/places.hpp"
#include "c/simulation.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;
using sunder::Index;
using sunder::Vec3;

std::span<const Index> to_nodes(const std::int32_t* nodes, std::size_t count) {
  if (count > 0) require(nodes, "nodes");
  require_rows(count, "nodes");
  return {nodes, count};
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_grasp(sunder_simulation simulation, const int32_t* nodes,
                                      size_t count, int32_t rigid, int32_t* grip) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(grip, "grip");
    const bool turns = choice<int>(rigid, 2, "rigid") == 1;
    *grip = object.simulation().grasp(to_nodes(nodes, count), turns);
  });
}

sunder_status sunder_simulation_grasp_near(sunder_simulation simulation, const double near[3],
                                           double radius, int32_t rigid, int32_t* grip) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(grip, "grip");
    const bool turns = choice<int>(rigid, 2, "rigid") == 1;
    *grip = object.simulation().grasp(to_place(near, "near"), to_radius(radius), turns);
  });
}

sunder_status sunder_simulation_held_nodes(sunder_simulation simulation, int32_t grip,
                                           int32_t* nodes, size_t capacity, size_t* count) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(count, "count");
    const auto held = object.simulation().held_nodes(grip);
    *count = held.size();
    if (!nodes && capacity == 0) return;
    require(nodes, "nodes");
    if (capacity < held.size()) {
      throw Failure(SUNDER_ERROR_SIZE, "nodes has room for " + std::to_string(capacity) +
                                           "; there are " + std::to_string(held.size()));
    }
    std::ranges::copy(held, nodes);
  });
}

sunder_status sunder_simulation_grip_place(sunder_simulation simulation, int32_t grip,
                                           double position[3]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(position, "position");
    std::copy_n(object.simulation().centre_of(grip).data(), 3, position);
  });
}

sunder_status sunder_simulation_pose(sunder_simulation simulation, int32_t grip,
                                     const double position[3], const double quaternion[4]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    sunder::Pose pose;
    pose.position = to_place(position, "position");
    if (quaternion) {
      require_finite(quaternion, 4, "quaternion");
      std::copy_n(quaternion, 4, pose.quaternion.begin());
      if (std::ranges::all_of(pose.quaternion, [](double q) { return q == 0; })) {
        throw Failure(SUNDER_ERROR_VALUE,
                      "quaternion has length 0; of no turn it is 0, 0, 0, 1 (x, y, z, w)");
      }
    }
    object.simulation().pose(grip, pose);
  });
}

sunder_status sunder_simulation_wrench(sunder_simulation simulation, int32_t grip, double force[3],
                                       double torque[3]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(force, "force");
    require(torque, "torque");
    const sunder::Wrench felt = object.simulation().wrench(grip);
    std::copy_n(felt.force.data(), 3, force);
    std::copy_n(felt.torque.data(), 3, torque);
  });
}

sunder_status sunder_simulation_release(sunder_simulation simulation, int32_t grip) {
  return call<SimulationObject>(
      simulation, [&](SimulationObject& object) { object.simulation().release(grip); });
}

sunder_status sunder_simulation_push(sunder_simulation simulation, const int32_t* nodes,
                                     size_t count, const double force[3], int32_t* push) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(push, "push");
    *push = object.simulation().push(to_nodes(nodes, count), to_place(force, "force"));
  });
}

sunder_status sunder_simulation_move(sunder_simulation simulation, int32_t push,
                                     const int32_t* nodes, size_t count, const double force[3]) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    object.simulation().move(push, to_nodes(nodes, count), to_place(force, "force"));
  });
}

sunder_status sunder_simulation_drop(sunder_simulation simulation, int32_t push) {
  return call<SimulationObject>(simulation,
                                [&](SimulationObject& object) { object.simulation().drop(push); });
}

}  // extern "C"
