// SPDX-License-Identifier: Apache-2.0
#include "sunder/problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "body/board_check.hpp"
#include "body/element.hpp"
#include "body/instrument_name.hpp"
#include "body/lay_interfaces.hpp"
#include "body/pools.hpp"
#include "body/selection.hpp"
#include "body/supports.hpp"
#include "material/linear.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/interfaces.hpp"
#include "sunder/scene_keys.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

void check_toughness(const std::string& what, const Material& m) {
  const auto check = [&what](const char* key, const std::optional<double>& value,
                             const char* unit) {
    if (!value || (std::isfinite(*value) && *value > 0)) return;
    throw InputError(InputFault::out_of_range, what + " has " + key + " = " + in_digits(*value) +
                                                   "; it must be finite and above 0 " + unit +
                                                   ", or left out (no crack grows by it)");
  };
  check("toughness", m.toughness, "MPa sqrt(mm)");
  check("energy", m.energy, "N/mm");
  if (m.toughness && m.energy) {
    throw InputError(InputFault::out_of_range,
                     what +
                         " has toughness and energy; they say the same (G_c = K_c^2/E'), so "
                         "give one of them");
  }
}

void check_material(const std::string& name, const Material& m) {
  const std::string what = "material " + in_quotes(name);
  if (!std::isfinite(m.young) || !(m.young > 0)) {
    throw InputError(InputFault::out_of_range, what + " has young = " + in_digits(m.young) +
                                                   "; it must be finite and above 0 MPa");
  }
  if (!(m.poisson > -1 && m.poisson < 0.5)) {
    throw InputError(InputFault::out_of_range, what + " has poisson = " + in_digits(m.poisson) +
                                                   "; it must lie above -1 and below 0.5");
  }
  if (m.yield && (!std::isfinite(*m.yield) || !(*m.yield > 0))) {
    throw InputError(InputFault::out_of_range,
                     what + " has yield = " + in_digits(*m.yield) +
                         "; it must be finite and above 0 MPa, or left out (unbreakable)");
  }
  check_toughness(what, m);
  if (m.density && (!std::isfinite(*m.density) || !(*m.density > 0))) {
    throw InputError(InputFault::out_of_range,
                     what + " has density = " + in_digits(*m.density) +
                         "; it must be finite and above 0 t/mm^3 (water 1e-9)");
  }
}

/// Ten times the densest metal: a figure in another unit.
constexpr double kDensest = 1e-7;
/// Of a step [s] in which tissue tears (method.md "Motion").
constexpr double kLongestTearingStep = 0.01;

void check_finite(const Vec3& v, const std::string& what, const char* key) {
  if (!v.allFinite()) {
    throw InputError(InputFault::out_of_range, what + " has a " + key + " that is not finite");
  }
}

}  // namespace

double Ramp::factor(double time) const {
  if (begin == end) return time >= begin ? 1.0 : 0.0;
  return std::clamp((time - begin) / (end - begin), 0.0, 1.0);
}

Problem::Problem(Scene scene) : scene_(std::move(scene)) {
  const std::string where = scene_.source.empty() ? "scene" : scene_.source;
  const Turned turned = turn_inverted(scene_.mesh);
  validate(scene_.mesh, where);
  if (turned.count > 0) warnings_.push_back(sentence(turned));
  try {
    check_options();
    std::optional<Mesh> as_it_came;
    if (!scene_.interfaces.empty()) as_it_came = scene_.mesh;
    fem::lay_interfaces(scene_);
    resolve_materials();
    build_shapes();
    interfaces_ = interfaces_of(scene_, shapes_);
    lay_fibres();
    make_pools();
    resolve_elements();
    std::vector<std::uint8_t> held = held_axes();
    select_instrument_nodes();
    const fem::Bodies bodies = fem::find_bodies(mesh(), {});
    leave_out_what_nothing_holds(bodies, held);
    latch_what_hangs(bodies, held);
    number_unknowns(held);
    resolve_grips();
    resolve_pulls();
    resolve_presses();
    check_held_bodies(bodies);
    // Layers of interfaces are thinner than what lies close to each other by mistake.
    if (as_it_came) std::swap(scene_.mesh, *as_it_came);
    note_odd_mesh();
    if (as_it_came) std::swap(scene_.mesh, *as_it_came);
    note_no_board();
    note_toughness();
  } catch (const InputError& error) {
    throw InputError(error.fault(), where + ": " + error.what());
  }
}

bool Problem::in_interface(Index e) const { return interfaces_ && interfaces_->has(e); }

void Problem::note_no_board() {
  if (!row_of(scene_.fracture.model).grows_cracks) return;
  if (const auto why = why_no_board(mesh(), scene_.fracture.plane_normal)) {
    warnings_.push_back("model " + in_quotes(row_of(scene_.fracture.model).name) +
                        " takes the body for a flat board of even thickness, but " + *why +
                        ": its cracks and their stress intensity are not those of this body "
                        "(docs/limits.md); model \"A\" assumes no shape");
  }
}

/// Of materials that elements have.
void Problem::note_toughness() {
  const FractureModelRow& model = row_of(scene_.fracture.model);
  std::vector<std::uint8_t> used(mesh().volumes.size(), 0);
  for (Index v : mesh().volume_of) used[static_cast<std::size_t>(v)] = 1;
  bool tough = false, yields = false;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Material& material = *material_of_volume_[v];
    yields = yields || material.yield;
    tough = tough || material.tough();
    if (!material.tough() || model.grows_cracks) continue;
    warnings_.push_back("material " + in_quotes(mesh().volumes[v].name) + " has " +
                        (material.toughness ? "toughness" : "energy") + ", which model " +
                        in_quotes(model.name) +
                        " does not read: cracks grow by it in model \"B\" alone");
  }
  if (model.grows_cracks && tough && !yields && scene_.cracks.empty()) {
    warnings_.push_back(
        "nothing can break: no material has a yield stress, by which a crack would start, and the "
        "scene has no crack that could grow; add yield or a [[crack]]");
  }
}

namespace {

/// The scene of a part.
Scene scene_of_part(const Scene& whole, const PartOfBody& part) {
  Scene scene = whole;
  Mesh mesh;
  mesh.volumes = whole.mesh.volumes;
  std::vector<Index> place(whole.mesh.nodes.size(), kNone);
  for (Index n : part.nodes) {
    place[n] = mesh.node_count();
    mesh.nodes.push_back(whole.mesh.nodes[n]);
  }
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

Problem::Problem(const Problem& whole, const PartOfBody& part)
    : scene_(scene_of_part(whole.scene_, part)) {
  resolve_materials();
  for (Index e : part.elements) shapes_.push_back(whole.shapes_[e]);
  take_fibres(whole, part.elements);
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

Problem::Problem(const Problem& whole, std::vector<std::array<Index, 4>> corners,
                 std::span<const NodeThatParts> nodes)
    : scene_(whole.scene_),
      shapes_(whole.shapes_),
      interfaces_(whole.interfaces_),
      dof_(whole.dof_),
      dof_count_(whole.dof_count_),
      gripped_dofs_(whole.gripped_dofs_),
      anchored_dofs_(whole.anchored_dofs_),
      anchor_stiffness_(whole.anchor_stiffness_) {
  resolve_materials();
  Mesh& mesh = scene_.mesh;
  pools_ = fem::parted_pools(whole, whole.pools_, corners);
  mesh.tets = std::move(corners);
  take_fibres(whole, {});
  for (const NodeThatParts& node : nodes) {
    mesh.nodes.push_back(Vec3(mesh.nodes[static_cast<std::size_t>(node.parent)]));
    for (int axis = 0; axis < 3; ++axis) {
      const auto grip = std::ranges::lower_bound(whole.gripped_dofs_, dof(node.parent, axis));
      // Where it has unknowns of its own, a grip that has come since holds its parent alone.
      const bool gripped = !node.axes.has(axis) && grip != whole.gripped_dofs_.end() &&
                           *grip == dof(node.parent, axis);
      dof_.push_back(node.axes.has(axis) || gripped ? dof_count_++ : kNone);
      if (!gripped) continue;
      gripped_dofs_.push_back(dof_.back());
      parted_grips_.push_back(static_cast<Index>(grip - whole.gripped_dofs_.begin()));
    }
  }
}

Problem::Problem(const Problem& whole, std::span<const Index> gripped)
    : scene_(whole.scene_),
      shapes_(whole.shapes_),
      pools_(whole.pools_),
      interfaces_(whole.interfaces_),
      dof_(whole.dof_),
      dof_count_(whole.dof_count_),
      gripped_dofs_(gripped.begin(), gripped.end()),
      anchor_stiffness_(whole.anchor_stiffness_) {
  resolve_materials();
  take_fibres(whole, {});
  std::ranges::sort(gripped_dofs_);
  for (Index d : whole.anchored_dofs_) {
    if (std::ranges::binary_search(gripped_dofs_, d)) anchored_dofs_.push_back(d);
  }
}

void Problem::check_crack(const FractureOptions& f, const FractureModelRow& model) {
  if (f.max_new_nodes < 0) {
    throw InputError(InputFault::out_of_range,
                     "fracture.max_new_nodes = " + std::to_string(f.max_new_nodes) +
                         "; it must be at least 0, the default");
  }
  if (f.crack != CrackWay::split) {
    if (!f.contact) return;
    throw InputError(
        InputFault::out_of_range,
        "fracture.contact = true needs fracture.crack = \"split\", whose lips it keeps "
        "apart");
  }
  if (!model.grows_cracks) {
    throw InputError(InputFault::out_of_range,
                     "fracture.crack = \"split\" needs model \"B\", which grows cracks; model " +
                         in_quotes(model.name) + " has none");
  }
  if (f.birth != FractureOptions{}.birth) {
    warnings_.push_back(
        "fracture.birth is not read: with crack \"split\" a rupture opens faces through the "
        "thickness "
        "and takes no element");
  }
  if (f.sif != SifSource::field) {
    warnings_.push_back(
        "fracture.sif = \"formula\" is not read: split cracks grow by K from the field");
  }
}

void Problem::check_options() {
  const FractureOptions& f = scene_.fracture;
  if (!(f.alpha > 0 && f.alpha < 1)) {
    throw InputError(InputFault::out_of_range, "fracture.alpha = " + in_digits(f.alpha) +
                                                   "; it must lie above 0 and below 1");
  }
  const FractureModelRow& model = row_of(f.model);
  if (model.measure && f.yield_measure != FractureOptions{}.yield_measure) {
    warnings_.push_back("fracture.yield_measure is not read: model " + in_quotes(model.name) +
                        " has a measure of its own");
  }
  check_crack(f, model);
  if (f.max_events < 1) {
    throw InputError(
        InputFault::out_of_range,
        "fracture.max_events = " + std::to_string(f.max_events) + "; it must be at least 1");
  }
  if (!(f.averaging >= 0 && std::isfinite(f.averaging))) {
    throw InputError(InputFault::out_of_range,
                     "fracture.averaging = " + in_digits(f.averaging) +
                         " must be a radius in mm, or 0: strength is judged by element");
  }
  if (f.plane_normal && !(f.plane_normal->allFinite() && f.plane_normal->norm() > 0)) {
    throw InputError(InputFault::out_of_range, "fracture.plane_normal must be finite and not zero");
  }
  if (!(scene_.solver.tolerance > 0 && scene_.solver.tolerance < 1)) {
    throw InputError(InputFault::out_of_range,
                     "solver.tolerance = " + in_digits(scene_.solver.tolerance) +
                         "; it must lie above 0 and below 1");
  }
  if (!(scene_.solver.max_ms >= 0 && std::isfinite(scene_.solver.max_ms))) {
    throw InputError(InputFault::out_of_range,
                     "solver.max_ms = " + in_digits(scene_.solver.max_ms) +
                         "; it must be finite and at least 0 ms (0: no bound)");
  }
  if (scene_.steps < 1) {
    throw InputError(InputFault::out_of_range,
                     "time.steps = " + std::to_string(scene_.steps) + "; it must be at least 1");
  }
  if (!scene_.gravity.allFinite()) {
    throw InputError(InputFault::out_of_range, "load.gravity must be finite, in mm/s^2");
  }
  if (moves()) check_motion();
}

void Problem::check_motion() {
  const Dynamics& d = *scene_.dynamics;
  const auto refuse = [](const std::string& key, double value, const std::string& what) {
    throw InputError(InputFault::out_of_range,
                     "dynamics." + key + " = " + in_digits(value) + "; it must be " + what);
  };
  if (!(d.time_step > 0) || !std::isfinite(d.time_step)) {
    refuse("time_step", d.time_step, "finite and above 0 s");
  }
  for (const double c : {d.mass_damping, d.stiffness_damping}) {
    if (!(c >= 0) || !std::isfinite(c)) refuse("damping", c, "finite and at least 0");
  }
  if (d.max_iterations < 0) refuse("max_iterations", d.max_iterations, "at least 0 (0: no cap)");
  if (d.time_step > kLongestTearingStep && row_of(scene_.fracture.model).breaks) {
    warnings_.push_back("dynamics.time_step = " + in_digits(d.time_step) +
                        " s is too coarse for tearing: more breaks than would in shorter steps; "
                        "take at most " +
                        in_digits(kLongestTearingStep) + " s");
  }
}

void Problem::check_density(const std::string& name, const Material& material) {
  const bool gravity = !scene_.gravity.isZero(0);
  if (!material.density && (moves() || gravity)) {
    throw InputError(InputFault::missing_key, "material " + in_quotes(name) +
                                                  " has no density, which " +
                                                  (moves() ? "motion" : "gravity") +
                                                  " needs; add density = 1e-9 (water, in t/mm^3)");
  }
  if (material.density && *material.density > kDensest) {
    warnings_.push_back("material " + in_quotes(name) +
                        " has density = " + in_digits(*material.density) +
                        ": denser than any metal; its unit is t/mm^3 (water 1e-9)");
  }
}

void Problem::resolve_materials() {
  reads_toughness_ = row_of(scene_.fracture.model).grows_cracks;
  for (const auto& [name, material] : scene_.materials) {
    check_material(name, material);
    const bool known =
        std::any_of(mesh().volumes.begin(), mesh().volumes.end(),
                    [&wanted = name](const NamedVolume& v) { return v.name == wanted; });
    if (!known) {
      std::vector<std::string> names;
      for (const NamedVolume& v : mesh().volumes) names.push_back(v.name);
      throw InputError(
          InputFault::unknown_name,
          "material " + in_quotes(name) + " names no volume; the mesh has " + name_list(names));
    }
  }
  std::vector<Index> elements(mesh().volumes.size(), 0);
  for (Index v : mesh().volume_of) ++elements[v];
  for (std::size_t v = 0; v < mesh().volumes.size(); ++v) {
    const auto it = scene_.materials.find(mesh().volumes[v].name);
    if (it == scene_.materials.end() && elements[v] > 0) {
      throw InputError(InputFault::no_material, "volume " + in_quotes(mesh().volumes[v].name) +
                                                    " (" + count_of(elements[v], "element") +
                                                    ") has no material; add [material." +
                                                    in_quotes(mesh().volumes[v].name) + "]");
    }
    const Material* material = it == scene_.materials.end() ? nullptr : &it->second;
    if (material && elements[v] > 0) check_density(it->first, *material);
    material_of_volume_.push_back(material);
    small_strain_of_volume_.push_back(material ? sunder::small_strain(*material) : SmallStrain{});
    finite_ = finite_ || (elements[v] > 0 && material->law != MaterialLaw::linear);
  }
  if (!finite_ && scene_.fracture.stress != FractureOptions{}.stress) {
    warnings_.push_back("fracture.stress is not read: at law \"linear\" all stresses are one");
  }
}

std::string Problem::law() const {
  const auto& names = key_words("material", "law");
  std::vector<std::uint8_t> used(names.size(), 0);
  for (Index v : mesh().volume_of) used[static_cast<std::size_t>(material_of_volume_[v]->law)] = 1;
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (used[i]) all += (all.empty() ? "" : ", ") + names[i];
  }
  return all;
}

void Problem::build_shapes() {
  shapes_.reserve(mesh().tets.size());
  for (const auto& t : mesh().tets) {
    const auto& x = mesh().nodes;
    shapes_.push_back(fem::tet_shape(x[t[0]], x[t[1]], x[t[2]], x[t[3]]));
  }
}

/// Past it linear tetrahedra lock: figures in docs/limits.md.
constexpr double kLocks = 0.49;

void Problem::make_pools() {
  std::vector<std::uint8_t> used(mesh().volumes.size(), 0);
  for (Index v : mesh().volume_of) used[static_cast<std::size_t>(v)] = 1;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Material& material = *material_of_volume_[v];
    const std::string what = "material " + in_quotes(mesh().volumes[v].name);
    if (material.volume == MaterialVolume::element && material.poisson > kLocks) {
      warnings_.push_back(what + " has poisson = " + in_digits(material.poisson) +
                          " with volume = \"element\": linear tetrahedra lock over 0.49, a thick "
                          "cylinder is 4 % too stiff at 0.49, 16 % at 0.499 and 24 % at 0.4999, "
                          "thin layers many times (docs/verification.md); volume = \"pooled\" does "
                          "not");
    }
  }
  pools_ = fem::pools_of(*this);
  if (pools_ && pools_->small_count() > 0) {
    warnings_.push_back(count_of(pools_->small_count(), "patch") +
                        " of pooled volume of fewer than " + std::to_string(fem::Pools::kFewest) +
                        " elements: pieces of a material that has no more; they are too stiff, as "
                        "with volume = \"element\" (docs/limits.md)");
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

}  // namespace sunder
