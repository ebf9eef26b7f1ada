// SPDX-License-Identifier: Apache-2.0
#include "sunder/problem.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "fem/element.hpp"
#include "fem/supports.hpp"
#include "material/linear.hpp"
#include "selection.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder {
namespace {

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

const char* axis_name(int axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

void check_material(const std::string& name, const Material& m) {
  const std::string what = "material " + in_quotes(name);
  if (!std::isfinite(m.young) || !(m.young > 0)) {
    throw InputError(InputFault::out_of_range, what + " has young = " + number(m.young) +
                                                   "; it must be finite and above 0 MPa");
  }
  if (!(m.poisson > -1 && m.poisson < 0.5)) {
    throw InputError(InputFault::out_of_range, what + " has poisson = " + number(m.poisson) +
                                                   "; it must lie above -1 and below 0.5");
  }
  if (m.yield && (!std::isfinite(*m.yield) || !(*m.yield > 0))) {
    throw InputError(InputFault::out_of_range,
                     what + " has yield = " + number(*m.yield) +
                         "; it must be finite and above 0 MPa, or left out (unbreakable)");
  }
}

void check_finite(const Vec3& v, const std::string& what, const char* key) {
  if (!v.allFinite()) {
    throw InputError(InputFault::out_of_range, what + " has a " + key + " that is not finite");
  }
}

void check_ramp(const Ramp& ramp, const std::string& what) {
  if (!std::isfinite(ramp.begin) || !std::isfinite(ramp.end) || !(ramp.begin <= ramp.end)) {
    throw InputError(InputFault::out_of_range,
                     what + " has ramp = [" + number(ramp.begin) + ", " + number(ramp.end) +
                         "]; it must be finite and must not run backwards");
  }
}

/// `"B" or "none"`.
std::string models_with_cracks() {
  std::string names;
  for (const FractureModelRow& row : fracture_models()) {
    if (row.keeps_cracks) names = in_quotes(row.name) + (names.empty() ? "" : " or " + names);
  }
  return names;
}

std::string instrument_name(const Instrument& instrument, std::size_t i) {
  return "instrument " + (instrument.name.empty() ? std::to_string(i) : in_quotes(instrument.name));
}

}  // namespace

double Ramp::factor(double time) const {
  if (begin == end) return time >= begin ? 1.0 : 0.0;
  return std::clamp((time - begin) / (end - begin), 0.0, 1.0);
}

Problem::Problem(Scene scene) : scene_(std::move(scene)) {
  const std::string where = scene_.source.empty() ? "scene" : scene_.source;
  validate(scene_.mesh, where);
  try {
    check_options();
    resolve_materials();
    build_shapes();
    resolve_elements();
    resolve_supports();
    resolve_instruments();
    check_held_bodies();
  } catch (const InputError& error) {
    throw InputError(error.fault(), where + ": " + error.what());
  }
}

namespace {

/// The scene of a part. Its ground is a copy of its first node, which nothing is ever computed of.
Scene scene_of_part(const Scene& whole, const PartOfBody& part) {
  Scene scene = whole;
  Mesh mesh;
  mesh.volumes = whole.mesh.volumes;
  std::vector<Index> place(whole.mesh.nodes.size(), kNone);
  for (Index n : part.nodes) {
    place[n] = mesh.node_count();
    mesh.nodes.push_back(whole.mesh.nodes[n]);
  }
  mesh.nodes.push_back(mesh.nodes.front());
  for (Index e : part.elements) {
    auto tet = whole.mesh.tets[e];
    for (Index& n : tet) n = place[n];
    mesh.tets.push_back(tet);
    mesh.volume_of.push_back(whole.mesh.volume_of[e]);
  }
  scene.mesh = std::move(mesh);
  return scene;
}

}  // namespace

Problem::Problem(const Problem& whole, const PartOfBody& part, Surroundings around)
    : scene_(scene_of_part(whole.scene_, part)), around_(std::move(around)) {
  resolve_materials();
  for (Index e : part.elements) shapes_.push_back(whole.shapes_[e]);
  dof_.assign(3 * mesh().nodes.size(), kNone);
  std::vector<Index> place(static_cast<std::size_t>(whole.dof_count_), kNone);
  for (std::size_t n = 0; n < part.nodes.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = whole.dof(part.nodes[n], axis);
      if (d != kNone) dof_[3 * n + axis] = place[d] = dof_count_++;
    }
  }
  const auto take = [&](const std::vector<Index>& from, std::vector<Index>& to) {
    for (Index d : from) {
      if (place[d] != kNone) to.push_back(place[d]);
    }
  };
  take(whole.gripped_dofs_, gripped_dofs_);
  take(whole.anchored_dofs_, anchored_dofs_);
  anchor_stiffness_ = whole.anchor_stiffness_;
}

void Problem::check_options() {
  const FractureOptions& f = scene_.fracture;
  if (!(f.alpha > 0 && f.alpha < 1)) {
    throw InputError(InputFault::out_of_range,
                     "fracture.alpha = " + number(f.alpha) + " must lie above 0 and below 1");
  }
  const FractureModelRow& model = row_of(f.model);
  if (model.measure && f.yield_measure != FractureOptions{}.yield_measure) {
    warnings_.push_back("fracture.yield_measure is not read: model " + in_quotes(model.name) +
                        " has a measure of its own");
  }
  if (f.max_events < 1) {
    throw InputError(
        InputFault::out_of_range,
        "fracture.max_events = " + std::to_string(f.max_events) + " must be at least 1");
  }
  if (!(f.averaging >= 0 && std::isfinite(f.averaging))) {
    throw InputError(InputFault::out_of_range,
                     "fracture.averaging = " + number(f.averaging) +
                         " must be a radius in mm, or 0: strength is judged by element");
  }
  if (f.plane_normal && !(f.plane_normal->allFinite() && f.plane_normal->norm() > 0)) {
    throw InputError(InputFault::out_of_range, "fracture.plane_normal must be finite and not zero");
  }
  if (!(scene_.solver.tolerance > 0 && scene_.solver.tolerance < 1)) {
    throw InputError(
        InputFault::out_of_range,
        "solver.tolerance = " + number(scene_.solver.tolerance) + " must lie above 0 and below 1");
  }
  if (scene_.steps < 1) {
    throw InputError(InputFault::out_of_range,
                     "time.steps = " + std::to_string(scene_.steps) + " must be at least 1");
  }
}

void Problem::resolve_materials() {
  for (const auto& [name, material] : scene_.materials) {
    check_material(name, material);
    const bool known =
        std::any_of(mesh().volumes.begin(), mesh().volumes.end(),
                    [&wanted = name](const NamedVolume& v) { return v.name == wanted; });
    if (!known) {
      std::string names;
      for (const NamedVolume& v : mesh().volumes) names.append(" ").append(in_quotes(v.name));
      throw InputError(InputFault::unknown_name,
                       "material " + in_quotes(name) + " names no volume; the mesh has" + names);
    }
  }
  std::vector<Index> elements(mesh().volumes.size(), 0);
  for (Index v : mesh().volume_of) ++elements[v];
  for (std::size_t v = 0; v < mesh().volumes.size(); ++v) {
    const auto it = scene_.materials.find(mesh().volumes[v].name);
    if (it == scene_.materials.end() && elements[v] > 0) {
      throw InputError(InputFault::no_material, "volume " + in_quotes(mesh().volumes[v].name) +
                                                    " (" + std::to_string(elements[v]) +
                                                    " elements) has no material; add [material." +
                                                    mesh().volumes[v].name + "]");
    }
    const Material* material = it == scene_.materials.end() ? nullptr : &it->second;
    material_of_volume_.push_back(material);
    small_strain_of_volume_.push_back(material ? sunder::small_strain(*material) : SmallStrain{});
  }
}

void Problem::build_shapes() {
  shapes_.reserve(mesh().tets.size());
  for (const auto& t : mesh().tets) {
    const auto& x = mesh().nodes;
    shapes_.push_back(fem::tet_shape(x[t[0]], x[t[1]], x[t[2]], x[t[3]]));
  }
}

void Problem::resolve_elements() {
  const bool cracks_kept = row_of(scene_.fracture.model).keeps_cracks;
  std::vector<int> owner(mesh().tets.size(), kNone);
  for (std::size_t c = 0; c < scene_.cracks.size(); ++c) {
    const PresetCrack& crack = scene_.cracks[c];
    const std::string what = "crack " + std::to_string(c);
    // A crack of split nodes is in the mesh already and takes no elements: an empty list says so.
    const auto* ids = std::get_if<std::vector<Index>>(&crack.elements);
    const bool split = ids && ids->empty();
    crack_elements_.push_back(split ? std::vector<Index>{}
                                    : select_elements(mesh(), crack.elements, what));
    const std::size_t tips = crack.tips.size();
    if (crack.mouth ? tips != 1 : tips != 2) {
      throw InputError(InputFault::missing_key,
                       what + (crack.mouth ? " has a mouth and needs one tip"
                                           : " has no mouth and needs two tips (internal crack)"));
    }
    if (crack.mouth) check_finite(*crack.mouth, what, "mouth");
    for (const Vec3& tip : crack.tips) check_finite(tip, what, "tip");
    const Vec3& start = crack.mouth ? *crack.mouth : crack.tips.front();
    if (cracks_kept && !((crack.tips.back() - start).norm() > 0)) {
      throw InputError(InputFault::out_of_range,
                       what + " has length 0; its path needs two different points");
    }
    for (Index e : crack_elements_.back()) {
      if (owner[e] != kNone) {
        throw InputError(InputFault::bad_id, what + " takes element " + std::to_string(e) +
                                                 ", which crack " + std::to_string(owner[e]) +
                                                 " has already");
      }
      owner[e] = static_cast<int>(c);
    }
  }
  for (std::size_t r = 0; r < scene_.removals.size(); ++r) {
    const ScriptedRemoval& removal = scene_.removals[r];
    const std::string what = "destroy " + std::to_string(r);
    if (removal.step < 0 || removal.step >= scene_.steps) {
      throw InputError(InputFault::out_of_range,
                       what + " is for step " + std::to_string(removal.step) +
                           ", but the scene has steps 0 to " + std::to_string(scene_.steps - 1));
    }
    removal_elements_.push_back(select_elements(mesh(), removal.elements, what));
  }
}

void Problem::resolve_supports() {
  std::vector<std::uint8_t> held(mesh().nodes.size(), 0);
  for (std::size_t s = 0; s < scene_.supports.size(); ++s) {
    const Support& support = scene_.supports[s];
    const std::string what = "fixed " + std::to_string(s);
    if (support.axes.bits == 0 || support.axes.bits > 7) {
      throw InputError(InputFault::out_of_range, what + " holds no axis; name some of x, y, z");
    }
    for (Index n : select_nodes(mesh(), support.nodes, what)) held[n] |= support.axes.bits;
  }
  dof_.assign(3 * mesh().nodes.size(), kNone);
  for (Index n = 0; n < node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!Axes{held[n]}.has(axis)) dof_[3 * n + axis] = dof_count_++;
    }
  }
}

void Problem::resolve_instruments() {
  std::vector<int> gripped_by(static_cast<std::size_t>(dof_count_), kNone);
  const auto& instruments = scene_.instruments;
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
    if (const auto* grip = std::get_if<Grip>(&instruments[i].action)) {
      check_finite(grip->displacement, what, "displacement");
      if (grip->axes.bits == 0 || grip->axes.bits > 7) {
        throw InputError(InputFault::out_of_range, what + " holds no axis; name some of x, y, z");
      }
      instrument_nodes_[i].nodes = select_nodes(mesh(), grip->nodes, what);
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
  }
  for (Index d = 0; d < dof_count_; ++d) {
    if (gripped_by[d] != kNone) gripped_dofs_.push_back(d);
  }
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const std::string what = instrument_name(instruments[i], i);
    if (const auto* pull = std::get_if<Pull>(&instruments[i].action)) {
      check_finite(pull->force, what, "force");
      instrument_nodes_[i].nodes = select_nodes(mesh(), pull->nodes, what);
      for (Index n : instrument_nodes_[i].nodes) {
        for (int axis = 0; axis < 3; ++axis) {
          const Index d = dof(n, axis);
          if (pull->force[axis] != 0 && (d == kNone || gripped_by[d] != kNone)) {
            throw InputError(
                InputFault::load_on_held_node,
                what + " pulls node " + std::to_string(n) + " along " + axis_name(axis) +
                    ", which " +
                    (d == kNone ? std::string("a support")
                                : instrument_name(instruments[gripped_by[d]], gripped_by[d])) +
                    " holds; select free nodes only");
          }
        }
      }
    } else if (const auto* press = std::get_if<Press>(&instruments[i].action)) {
      check_finite(press->force, what, "force");
      check_finite(press->at, what, "at");
      const int presets = static_cast<int>(scene_.cracks.size());
      if (!row_of(scene_.fracture.model).keeps_cracks) {
        throw InputError(InputFault::unknown_name,
                         what + " presses on a crack, but model " +
                             in_quotes(row_of(scene_.fracture.model).name) +
                             " keeps no cracks; use model " + models_with_cracks());
      }
      if (press->crack < 0 ||
          (press->crack >= presets && !row_of(scene_.fracture.model).grows_cracks)) {
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
}

void Problem::check_held_bodies() {
  const fem::Bodies bodies = fem::find_bodies(mesh(), {});
  std::vector<std::vector<fem::HeldDof>> held(static_cast<std::size_t>(bodies.count));
  std::vector<std::vector<fem::HeldDof>> gripped(held.size());
  for (Index n = 0; n < node_count(); ++n) {
    if (bodies.body_of_node[n] == kNone) {
      throw InputError(InputFault::unsupported_body,
                       "node " + std::to_string(n) +
                           " belongs to no element and cannot be held; drop unused nodes");
    }
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
  for (Index b = 0; b < bodies.count; ++b) {
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
                           ") is not held: " + std::to_string(left) +
                           " rigid modes are left; hold it with [[fixed]] or a grip");
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

}  // namespace sunder
