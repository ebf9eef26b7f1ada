// SPDX-License-Identifier: Apache-2.0
// What holds and drives a body: supports, instruments, unknowns, and what nothing holds.
#include <algorithm>
#include <array>
#include <cmath>

#include "body/hanging_parts.hpp"
#include "body/instrument_name.hpp"
#include "body/mesh_findings.hpp"
#include "body/selection.hpp"
#include "body/supports.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/problem.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

constexpr std::uint8_t kAllAxes = 7;

const char* axis_name(int axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

void check_finite(const Vec3& v, const std::string& what, const char* key) {
  if (!v.allFinite()) {
    throw InputError(InputFault::out_of_range, what + " has a " + key + " that is not finite");
  }
}

void check_ramp(const Ramp& ramp, const std::string& what) {
  if (!std::isfinite(ramp.begin) || !std::isfinite(ramp.end) || !(ramp.begin <= ramp.end)) {
    throw InputError(InputFault::out_of_range,
                     what + " has ramp = [" + in_digits(ramp.begin) + ", " + in_digits(ramp.end) +
                         "]; it must be finite and must not run backwards");
  }
}

void check_axes(Axes axes, const std::string& what) {
  if (axes.bits == 0 || axes.bits > kAllAxes) {
    throw InputError(InputFault::out_of_range, what + " holds no axis; name some of x, y, z");
  }
}

void check_turn(const Grip& grip, const std::string& what) {
  check_finite(grip.turn, what, "turn");
  if (grip.rigid && grip.axes.bits != kAllAxes) {
    throw InputError(InputFault::out_of_range,
                     what + " is rigid and must hold the axes \"xyz\", not some of them");
  }
  if (!grip.rigid && !grip.turn.isZero(0)) {
    throw InputError(InputFault::out_of_range,
                     what + " turns without being rigid; add rigid = true");
  }
}

const NodeSelection* nodes_of(const Instrument& instrument) {
  if (const auto* grip = std::get_if<Grip>(&instrument.action)) return &grip->nodes;
  if (const auto* pull = std::get_if<Pull>(&instrument.action)) return &pull->nodes;
  return nullptr;
}

std::string name_of_grip(std::span<const Instrument> instruments,
                         std::span<const InstrumentNodes> nodes, Index node, int axis) {
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    const auto& of = nodes[i].nodes;
    if (grip && grip->axes.has(axis) && std::binary_search(of.begin(), of.end(), node))
      return instrument_name(instruments[i], i);
  }
  return "a grip";
}

Vec3 centroid(const Mesh& mesh, Index e) {
  Vec3 sum = Vec3::Zero();
  for (Index n : mesh.tets[e]) sum += mesh.nodes[n];
  return sum / 4;
}

/// "x of 3 nodes and y of 1 node"
std::string held_of_nodes(const std::array<Index, 3>& held) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    if (held[axis] == 0) continue;
    text.append(text.empty() ? "" : " and ").append(axis_name(axis));
    text.append(" of ").append(count_of(held[axis], "node"));
  }
  return text;
}

}  // namespace

/// Per node the axes that supports hold, as bits.
std::vector<std::uint8_t> Problem::held_axes() const {
  std::vector<std::uint8_t> held(mesh().nodes.size(), 0);
  for (std::size_t s = 0; s < scene_.supports.size(); ++s) {
    const Support& support = scene_.supports[s];
    const std::string what = "fixed " + std::to_string(s);
    check_axes(support.axes, what);
    for (Index n : select_nodes(mesh(), support.nodes, what)) held[n] |= support.axes.bits;
  }
  return held;
}

void Problem::select_instrument_nodes() {
  const auto& instruments = scene_.instruments;
  const std::vector<std::uint8_t> used = used_nodes(mesh());
  instrument_nodes_.resize(instruments.size());
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const std::string what = instrument_name(instruments[i], i);
    for (std::size_t j = 0; j < i; ++j) {
      if (!instruments[i].name.empty() && instruments[j].name == instruments[i].name) {
        throw InputError(InputFault::duplicate_name,
                         what + " is named twice; give every instrument a name of its own");
      }
    }
    if (instruments[i].ramp) check_ramp(*instruments[i].ramp, what);
    const NodeSelection* selection = nodes_of(instruments[i]);
    if (!selection) continue;
    auto& nodes = instrument_nodes_[i].nodes;
    nodes = select_nodes(mesh(), *selection, what);
    const auto unused = std::find_if(nodes.begin(), nodes.end(), [&](Index n) { return !used[n]; });
    if (unused != nodes.end()) {
      throw InputError(InputFault::bad_id, what + " names node " + std::to_string(*unused) +
                                               ", which no element uses; take it out");
    }
  }
}

/// Unused nodes and bodies that nothing holds or drives get no unknowns: they stay where they are
/// and disturb nothing. A body that is driven but not held is an error (check_held_bodies).
void Problem::leave_out_what_nothing_holds(const fem::Bodies& bodies,
                                           std::vector<std::uint8_t>& held) {
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(bodies.count), 0);
  for (Index n = 0; n < node_count(); ++n) {
    if (held[n] != 0 && bodies.body_of_node[n] != kNone) wanted[bodies.body_of_node[n]] = 1;
  }
  for (const InstrumentNodes& i : instrument_nodes_) {
    for (Index n : i.nodes) wanted[bodies.body_of_node[n]] = 1;
  }
  const auto any = std::any_of(wanted.begin(), wanted.end(), [](auto w) { return w != 0; });
  // In motion such a body flies; with no other it is an error, not a warning.
  if (!any || moves()) std::fill(wanted.begin(), wanted.end(), std::uint8_t{1});
  for (Index n = 0; n < node_count(); ++n) {
    const Index body = bodies.body_of_node[n];
    if (body == kNone || !wanted[body]) held[n] = kAllAxes;
  }
  const auto left_out = std::count(wanted.begin(), wanted.end(), std::uint8_t{0});
  if (left_out == 0) return;
  Index elements = 0, first = kNone;
  for (Index e = 0; e < tet_count(); ++e) {
    if (wanted[bodies.body_of_element[e]]) continue;
    if (elements++ == 0) first = e;
  }
  warnings_.push_back(
      count_of(left_out, "body", "bodies") + " with " + count_of(elements, "element") +
      " (first: element " + std::to_string(first) + " at " + place(centroid(mesh(), first)) +
      "): nothing holds or drives " +
      (left_out == 1 ? "it, and it stays where it is" : "them, and they stay where they are") +
      "; hold with [[fixed]] or a grip, or join to the rest");
}

void Problem::latch_what_hangs(const fem::Bodies& bodies, std::vector<std::uint8_t>& held) {
  if (moves()) return;  // it swings
  std::vector<std::uint8_t> restrained = held;
  for (std::size_t i = 0; i < scene_.instruments.size(); ++i) {
    if (!std::holds_alternative<Grip>(scene_.instruments[i].action)) continue;
    for (Index n : instrument_nodes_[i].nodes) restrained[n] = 1;
  }
  const std::vector<HangingPart> parts = find_hanging_parts(mesh(), bodies, restrained);
  if (parts.empty()) return;
  Index elements = 0;
  for (const HangingPart& part : parts) {
    elements += part.elements;
    for (const fem::HeldDof& d : part.latches)
      held[d.node] |= static_cast<std::uint8_t>(1U << static_cast<unsigned>(d.axis));
  }
  const Index first = parts.front().first;
  warnings_.push_back(
      count_of(static_cast<long long>(parts.size()), "part hangs", "parts hang") +
      " on the rest by a node or an edge only (" + count_of(elements, "element") +
      ", first: element " + std::to_string(first) + " at " + place(centroid(mesh(), first)) +
      ") and can turn about it; how far has no meaning, and what drives such a part goes into a " +
      "support: join it by faces, or hold it");
}

void Problem::number_unknowns(std::span<const std::uint8_t> held) {
  dof_.assign(3 * mesh().nodes.size(), kNone);
  for (Index n = 0; n < node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!Axes{held[n]}.has(axis)) dof_[3 * n + axis] = dof_count_++;
    }
  }
}

void Problem::resolve_grips() {
  std::vector<int> gripped_by(static_cast<std::size_t>(dof_count_), kNone);
  const auto& instruments = scene_.instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    if (!grip) continue;
    const std::string what = instrument_name(instruments[i], i);
    check_finite(grip->displacement, what, "displacement");
    check_axes(grip->axes, what);
    check_turn(*grip, what);
    for (Index n : instrument_nodes_[i].nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!grip->axes.has(axis)) continue;
        const Index d = dof(n, axis);
        if (d == kNone || gripped_by[d] != kNone) {
          throw InputError(
              InputFault::conflicting_supports,
              what + " prescribes " + axis_name(axis) + " of node " + std::to_string(n) +
                  ", which " +
                  (d == kNone ? std::string("a support")
                              : instrument_name(instruments[gripped_by[d]], gripped_by[d])) +
                  " holds already; take the node out of one of them");
        }
        gripped_by[d] = static_cast<int>(i);
      }
    }
  }
  for (Index d = 0; d < dof_count_; ++d) {
    if (gripped_by[d] != kNone) gripped_dofs_.push_back(d);
  }
}

/// What a pull puts on an axis that a support holds goes into the reaction; on one that a grip
/// holds it is refused, since the grip's force is the answer asked for.
void Problem::resolve_pulls() {
  for (std::size_t i = 0; i < scene_.instruments.size(); ++i) {
    const auto* pull = std::get_if<Pull>(&scene_.instruments[i].action);
    if (!pull) continue;
    const std::string what = instrument_name(scene_.instruments[i], i);
    check_finite(pull->force, what, "force");
    const auto& nodes = instrument_nodes_[i].nodes;
    std::array<Index, 3> held{};
    for (Index n : nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (pull->force[axis] == 0) continue;
        const Index d = dof(n, axis);
        if (d == kNone) ++held[axis];
        if (d == kNone || !std::binary_search(gripped_dofs_.begin(), gripped_dofs_.end(), d))
          continue;
        throw InputError(InputFault::load_on_held_node,
                         what + " pulls node " + std::to_string(n) + " along " + axis_name(axis) +
                             ", which " +
                             name_of_grip(scene_.instruments, instrument_nodes_, n, axis) +
                             " holds; select free nodes only");
      }
    }
    if (held == std::array<Index, 3>{}) continue;
    Vec3 share;
    for (int axis = 0; axis < 3; ++axis)
      share[axis] = pull->force[axis] * held[axis] / static_cast<double>(nodes.size());
    warnings_.push_back(what + " pulls on what supports hold (" + held_of_nodes(held) + " out of " +
                        std::to_string(nodes.size()) + "): " + place(share) + " N of its " +
                        place(pull->force) + " N go straight into the supports' reaction");
  }
}

namespace {

/// `"B" or "none"`.
std::string models_with_cracks() {
  std::string names;
  for (const FractureModelRow& row : fracture_models()) {
    if (row.keeps_cracks) names = in_quotes(row.name) + (names.empty() ? "" : " or " + names);
  }
  return names;
}

}  // namespace

void Problem::resolve_presses() {
  const int presets = static_cast<int>(scene_.cracks.size());
  for (std::size_t i = 0; i < scene_.instruments.size(); ++i) {
    const auto* press = std::get_if<Press>(&scene_.instruments[i].action);
    if (!press) continue;
    const std::string what = instrument_name(scene_.instruments[i], i);
    check_finite(press->force, what, "force");
    check_finite(press->at, what, "at");
    const FractureModelRow& model = row_of(scene_.fracture.model);
    if (!model.keeps_cracks) {
      throw InputError(InputFault::unknown_name,
                       what + " presses on a crack, but model " + in_quotes(model.name) +
                           " keeps no cracks; use model " + models_with_cracks());
    }
    if (press->crack < 0 || (press->crack >= presets && !model.grows_cracks)) {
      throw InputError(InputFault::unknown_name,
                       what + " presses on crack " + std::to_string(press->crack) +
                           ", but the scene presets " + std::to_string(presets));
    }
    if (press->crack >= presets) {
      warnings_.push_back(what + " presses on crack " + std::to_string(press->crack) +
                          " and acts only once that crack is born");
    }
  }
}

void Problem::check_held_bodies(const fem::Bodies& bodies) {
  std::vector<std::vector<fem::HeldDof>> held(static_cast<std::size_t>(bodies.count));
  std::vector<std::vector<fem::HeldDof>> gripped(held.size());
  for (Index n = 0; n < node_count(); ++n) {
    if (bodies.body_of_node[n] == kNone) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = dof(n, axis);
      if (d == kNone) {
        held[bodies.body_of_node[n]].push_back({n, axis});
      } else if (std::binary_search(gripped_dofs_.begin(), gripped_dofs_.end(), d)) {
        gripped[bodies.body_of_node[n]].push_back({n, axis});
      }
    }
  }
  double stiffest = 0;
  for (const auto& [name, m] : scene_.materials) stiffest = std::max(stiffest, m.young);
  for (Index b = 0; b < bodies.count && !moves(); ++b) {
    if (fem::rigid_modes_left(mesh(), held[b]) == 0) continue;
    auto all = held[b];
    all.insert(all.end(), gripped[b].begin(), gripped[b].end());
    const int left = fem::rigid_modes_left(mesh(), all);
    if (left > 0) {
      const auto& of = bodies.body_of_element;
      const auto first = std::find(of.begin(), of.end(), b) - of.begin();
      throw InputError(InputFault::unsupported_body,
                       "the body with element " + std::to_string(first) + " (body " +
                           std::to_string(b) + " of " + std::to_string(bodies.count) +
                           ") is not held: " + count_of(left, "rigid mode is", "rigid modes are") +
                           " left; hold it with [[fixed]] or a grip");
    }
    for (const fem::HeldDof& g : gripped[b]) anchored_dofs_.push_back(dof(g.node, g.axis));
    // Of the size of a node's own stiffness, so that the condition of K0 does not suffer.
    anchor_stiffness_ = stiffest * std::cbrt(shapes_.front().volume);
  }
  if (dof_count_ == 0) {
    throw InputError(InputFault::unsupported_body,
                     "every node is held on every axis; leave something free to move");
  }
}

void Problem::note_odd_mesh() {
  if (const DuplicateElements twice = find_duplicates(mesh()); twice.count > 0) {
    warnings_.push_back(count_of(twice.count, "element has", "elements have") +
                        " the same four nodes as another (first: elements " +
                        std::to_string(twice.of) + " and " + std::to_string(twice.first) + " at " +
                        place(centroid(mesh(), twice.first)) +
                        "): the stiffness of each counts; leave one of them unless that is meant");
  }
  std::vector<Vec3> declared;  // cracks of split nodes
  for (std::size_t c = 0; c < scene_.cracks.size(); ++c) {
    if (!crack_elements_[c].empty()) continue;
    const PresetCrack& crack = scene_.cracks[c];
    declared.insert(declared.end(), crack.tips.begin(), crack.tips.end());
    if (crack.mouth) declared.push_back(*crack.mouth);
  }
  Vec3 normal = Vec3::UnitZ();
  if (!declared.empty()) normal = board_plane(mesh(), scene_.fracture.plane_normal).e3;
  const HiddenCut cut = find_hidden_cut(mesh(), declared, normal);
  if (cut.faces == 0) return;
  warnings_.push_back(count_of(cut.faces, "pair") + " of faces lie on each other without being " +
                      "joined, since " + count_of(cut.nodes, "node repeats", "nodes repeat") +
                      " the place of another (first: elements " + std::to_string(cut.element) +
                      " and " + std::to_string(cut.other) + " at " + place(cut.place) +
                      "): the body is cut there; merge the nodes unless that is meant");
}

}  // namespace sunder
