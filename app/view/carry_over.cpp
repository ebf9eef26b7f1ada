// SPDX-License-Identifier: Apache-2.0
#include "app/view/carry_over.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "app/output/text.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

/// What has gone; not what is a crack of the scene's, which the other body has as well.
std::vector<Index> gone_from(const Body& from, const Body& to) {
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(to.simulation.problem().tet_count()));
  for (const auto& crack : to.simulation.problem().crack_elements()) {
    for (const Index e : crack) taken[static_cast<std::size_t>(e)] = 1;
  }
  std::vector<Index> gone;
  for (const DestroyedElement& row : from.simulation.destroyed()) {
    if (row.element == kNone || row.lives || row.cause == Cause::preset) continue;
    auto& is_taken = taken[static_cast<std::size_t>(row.element)];
    if (!is_taken) gone.push_back(row.element);
    is_taken = 1;
  }
  return gone;
}

void drive_as(const Body& from, Body& to) {
  const auto& before = from.simulation.problem().scene().instruments;
  const auto& now = to.simulation.problem().scene().instruments;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const auto same = std::ranges::find(before, now[i].name, &Instrument::name);
    if (same == before.end() || same->action.index() != now[i].action.index()) continue;
    const auto was = static_cast<std::size_t>(same - before.begin());
    if (from.hand.driven(was) || same->ramp) {
      to.hand.drive({now[i].name, from.hand.value(was), false, i});
    }
    const auto* grip = std::get_if<Grip>(&now[i].action);
    if (!grip || !grip->rigid || !std::get<Grip>(same->action).rigid) continue;
    if (from.hand.turned(was) || same->ramp) {
      to.hand.turn({now[i].name, from.hand.rotation(was), i});
    }
  }
}

/// False: none of its nodes can be taken.
bool hold_as(const Hand::Held& held, const Body& from, Body& to, Carried& carried) {
  input::Grasp grasp;
  grasp.rigid = held.rigid;
  for (const Index n : from.simulation.held_nodes(held.grip)) {
    if (n < to.simulation.problem().node_count()) grasp.nodes.push_back(n);
  }
  if (grasp.nodes.empty()) return false;
  input::Pose pose;
  try {
    pose.grip = to.hand.grasp(grasp);
  } catch (const UsageError&) {
    return false;
  }
  const auto& q = held.quaternion;
  const Eigen::Quaterniond turned = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized();
  pose.position = from.simulation.centre_of(held.grip) + turned * held.offset;
  pose.quaternion = q;
  to.hand.pose(pose);
  carried.grips[held.grip] = pose.grip;
  return true;
}

}  // namespace

std::string Carried::sentence() const {
  std::string words;
  const auto say = [&](const std::string& what) { words += (words.empty() ? "" : ", ") + what; };
  if (elements > 0) {
    say(counted(elements, "element") + (elements == 1 ? " stays gone" : " stay gone"));
  }
  if (closed_cracks > 0) {
    say(counted(closed_cracks, "split crack") +
        (closed_cracks == 1 ? " is whole again" : " are whole again"));
  }
  if (!grips.empty()) {
    say(counted(static_cast<int>(grips.size()), "grip") +
        (grips.size() == 1 ? " holds on" : " hold on"));
  }
  if (grips_let_go > 0) {
    say(counted(grips_let_go, "grip") + (grips_let_go == 1 ? " has let go" : " have let go"));
  }
  return words;
}

Carried carry_over(const Body& from, Body& to) {
  Carried carried;
  const std::vector<Index> gone = gone_from(from, to);
  to.hand.remove(gone);
  carried.elements = static_cast<int>(gone.size());
  std::vector<int> split;
  for (const CrackFace& face : from.simulation.crack_faces()) split.push_back(face.crack);
  std::sort(split.begin(), split.end());
  carried.closed_cracks = static_cast<int>(std::unique(split.begin(), split.end()) - split.begin());
  const bool moves = from.simulation.problem().moves() || to.simulation.problem().moves();
  for (const Hand::Held& held : from.hand.held()) {
    if (moves || !hold_as(held, from, to, carried)) ++carried.grips_let_go;
  }
  if (moves || from.hand.recording().empty()) return carried;
  drive_as(from, to);
  if (from.simulation.steps_done() > 0) {
    to.step();
    carried.stepped = true;
  }
  return carried;
}

}  // namespace sunder::app
