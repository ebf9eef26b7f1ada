// SPDX-License-Identifier: Apache-2.0
#include "sunder/scene_keys.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <type_traits>

#include "sunder/fracture_model.hpp"
#include "sunder/tissue_presets.hpp"

namespace sunder {
namespace {

// ---- What a key is, by the member that it fills -------------------------------------------------

template <class Owner, class T>
struct MemberOf {
  using owner = Owner;
  using type = T;
};
template <class Owner, class T>
MemberOf<Owner, T> member_of(T Owner::*);
template <auto kMember>
using Of = decltype(member_of(kMember));

template <class T>
struct Plain {
  using type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using type = T;
};

template <class T>
constexpr KeyType key_type() {
  if constexpr (std::is_enum_v<T>) return KeyType::word;
  if constexpr (std::is_same_v<T, bool>) return KeyType::boolean;
  if constexpr (std::is_same_v<T, int>) return KeyType::integer;
  if constexpr (std::is_same_v<T, double>) return KeyType::number;
  if constexpr (std::is_same_v<T, Vec3>) return KeyType::vector;
  return KeyType::text;
}

template <auto kMember>
void set_member(typename Of<kMember>::owner& owner, const KeyValue& value) {
  using T = typename Plain<typename Of<kMember>::type>::type;
  if constexpr (std::is_enum_v<T>) {
    owner.*kMember = static_cast<T>(std::get<int>(value));
  } else {
    owner.*kMember = std::get<T>(value);
  }
}

template <auto kMember>
std::optional<KeyValue> get_member(const typename Of<kMember>::owner& owner) {
  using T = typename Of<kMember>::type;
  if constexpr (std::is_enum_v<T>) {
    return KeyValue(static_cast<int>(owner.*kMember));
  } else if constexpr (std::is_same_v<T, typename Plain<T>::type>) {
    return KeyValue(owner.*kMember);
  } else {
    const auto& value = owner.*kMember;
    return value ? std::optional(KeyValue(*value)) : std::nullopt;
  }
}

// ---- Defaults as a scene would write them -------------------------------------------------------

std::string written(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  const std::size_t zero = text.find("e-0");  // 1e-06
  return zero == std::string::npos ? text : text.erase(zero + 2, 1);
}

std::string written(const SceneKey& key, const KeyValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value)) return written(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return "\"" + *text + "\"";
  if (const auto* v = std::get_if<Vec3>(&value)) {
    return "[" + written(v->x()) + ", " + written(v->y()) + ", " + written(v->z()) + "]";
  }
  const int count = std::get<int>(value);
  if (key.type == KeyType::word) return "\"" + key.words[static_cast<std::size_t>(count)] + "\"";
  return count < key.least ? "" : std::to_string(count);  // below: none, whatever stands for it
}

struct More {
  std::vector<std::string> words = {};
  int least = 0;
  bool required = false;
};

template <auto kMember>
auto row(std::string_view table, std::string_view name, std::string_view meaning,
         std::string_view wrong, More more = {}) {
  using Owner = typename Of<kMember>::owner;
  MemberKey<Owner> key;
  key.table = table;
  key.name = name;
  key.type = key_type<typename Plain<typename Of<kMember>::type>::type>();
  key.meaning = meaning;
  key.wrong = wrong;
  key.words = std::move(more.words);
  key.least = more.least;
  key.required = more.required;
  key.get = get_member<kMember>;
  key.set = set_member<kMember>;
  const auto standard = key.get(Owner{});
  if (standard && !key.required) key.standard = written(key, *standard);
  return key;
}

/// A key that something else than one member is made of.
SceneKey row(std::string_view table, std::string_view name, KeyType type, std::string standard,
             std::string_view meaning, std::string_view wrong, More more = {}) {
  return {
      table,         name,      type, meaning, wrong, std::move(more.words), std::move(standard),
      more.required, more.least};
}

const More kRequired{.required = true};

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const FractureModelRow& model : fracture_models()) names.emplace_back(model.name);
  return names;
}

// ---- The rows -----------------------------------------------------------------------------------

std::vector<SceneKey> root_rows() {
  using enum KeyType;
  return {
      row("", "title", text, "", "for figures and reports", "left out: the file's name"),
      row("", "mesh", text, "",
          "path, relative to the scene: .msh 1, 2.2 and 4.1 (ascii, binary), .vtk, .vtu "
          "(`result.vtu` "
          "too), .mesh, .unv, .bdf, .nas: \"Meshes\" below",
          "empty, not there, not a mesh: error", kRequired),
      row("", "inputs", text, "",
          "path, relative to the scene: what is done between steps, one input a line "
          "([view.md](view.md) \"Inputs\"), as `sunder view` records it; every element may be "
          "removed then, and the run ends with the last input",
          "not there, no such input: error; `sweep`: error"),
      row("", "recording", text, "",
          "path, relative to the scene: what a host did to a simulation of this scene, as "
          "`sunder_simulation_store` gives it ([embedding.md](embedding.md) \"A live body\"); "
          "`run` "
          "does it again, bit by bit, and ends with its last action",
          "not there, damaged, of another body, scene, solver or version, or `inputs` beside it: "
          "error; `sweep`, `view`: error"),
      row("", "material", table, "", "one table a named volume", "no such volume: error"),
      row("", "fixed", tables, "", "supports", "a body that can move as one: error"),
      row("", "instrument", tables, "", "what pulls, grips and presses; any number", ""),
      row("", "crack", tables, "", "preset cracks", ""),
      row("", "interface", tables, "",
          "surfaces between two volumes that part by a law of their own (method.md "
          "\"Interfaces\"); "
          "they make the scene one of finite deformation",
          "model \"B\", `fracture.averaging`: error"),
      row("", "destroy", tables, "", "elements removed by script", ""),
      row("", "fracture", table, "", "what breaks, and how", ""),
      row("", "solver", table, "", "how it is computed", ""),
      row("", "time", table, "", "how often", ""),
      row("", "output", table, "", "what is stored", ""),
      row("", "load", table, "", "what acts on all of the body", ""),
      row("", "dynamics", table, "",
          "motion (method.md \"Motion\"): the table's presence makes each step one of time; "
          "supports "
          "and instruments may be absent",
          "a device, route, update or precision that cannot: exit code 4"),
  };
}

SceneKey fibres_row() {
  return row("material", "fibres", KeyType::tables, "",
             "a family of fibres, a table; or two families, an array of two tables (method.md "
             "\"Fibres\")",
             "three; two with law \"linear\"; with a model that grows cracks, but for "
             "`toughness_across`: error");
}

std::vector<SceneKey> fibre_rows() {
  using enum KeyType;
  return {
      row("fibres", "direction", vector, "", "where they run, in all of the material",
          "zero; two of `direction`, `around`, `curve` and `field`, or none: error"),
      row("fibres", "surface", text, "",
          "name of a surface: `direction` is laid along it, in each element as at its nearest "
          "triangle",
          "without `direction`, no such surface, `direction` across it somewhere: error"),
      row("fibres", "around", table, "",
          "{point = [x, y, z], axis = [x, y, z]}: round that axis [mm]",
          "axis zero, an element's centroid on it: error"),
      row("fibres", "curve", curve, "",
          "points of a polyline, to whose nearest piece they are parallel [mm]",
          "fewer than two, one twice in a row: error"),
      row("fibres", "field", text, "",
          "name of an array of vectors, one a cell, in the mesh file (.vtu)",
          "no such array, a vector zero: error"),
      row("fibres", "k1", number, "",
          "laws of finite deformation: stiffness of slack fibres as they tighten [MPa], needed "
          "there",
          "0 or below, law \"linear\": error"),
      row("fibres", "k2", number, "",
          "laws of finite deformation: how fast they stiffen, needed there",
          "below 0, law \"linear\": error"),
      row("fibres", "dispersion", number, "0",
          "laws of finite deformation: kappa, from 0 (all along) to 1/3 (as many in every "
          "direction)",
          "outside, law \"linear\": error"),
      row("fibres", "young_along", number, "",
          "law \"linear\": Young's modulus along [MPa], needed there; `young` and `poisson` hold "
          "across",
          "0 or below, another law: error"),
      row("fibres", "poisson_along", number, "",
          "law \"linear\": contraction across by extension along, needed there",
          "not positive definite, another law: error"),
      row("fibres", "shear_along", number, "",
          "law \"linear\": shear modulus of planes along [MPa], needed there",
          "0 or below, another law: error"),
      row("fibres", "yield_across", number, "",
          "strength across [MPa]; `yield` holds along; left out: as along",
          "0 or below, no `yield`, a second family, `fracture.averaging`, a law but \"linear\" "
          "with "
          "`fracture.stress` \"cauchy\": error"),
      row("fibres", "toughness_across", number, "",
          "K_c of cracks across [MPa sqrt(mm)]; `toughness` holds along (method.md \"Toughness by "
          "direction\"); such fibres have no stiffness",
          "0 or below, no `toughness`, beside a stiffness, `yield_across` or a second family, a "
          "model but \"B\", `fracture.sif` \"formula\": error"),
      row("fibres", "energy_across", number, "",
          "G_c of cracks across [N/mm], where `energy` holds along", "as `toughness_across`"),
      row("around", "point", vector, "", "on the axis [mm]", "", kRequired),
      row("around", "axis", vector, "", "its direction", "zero: error", kRequired),
  };
}

std::vector<SceneKey> body_rows() {
  using enum KeyType;
  return {
      row("fixed", "", nodes, "", "the nodes held", "none: error"),
      row("fixed", "axes", text, "\"xyz\"", "the axes held", "other letters, one twice: error"),
      row("instrument", "name", text, "", "in results; left out: \"instrument-\" and its index",
          "given twice: error"),
      row("instrument", "kind", word, "",
          "what it does: \"expansion\" pulls or grips nodes, \"pressure\" presses on a face of a "
          "crack",
          "", {.words = {"expansion", "pressure"}, .required = true}),
      row("instrument", "force", vector, "",
          "expansion: in equal parts on its nodes, in total [N]; pressure: on the face [N]",
          "beside `displacement`, or on an axis that a grip holds: error; on one that a support "
          "holds: "
          "warning"),
      row("instrument", "displacement", vector, "",
          "expansion: a grip that holds its nodes from the start and moves them [mm]",
          "beside `force`, or of a held node: error"),
      row("instrument", "axes", text, "\"xyz\"", "axes that a grip holds",
          "without `displacement`: error"),
      row("instrument", "rigid", boolean, "false",
          "a grip whose nodes move as one solid, which may turn",
          "without `displacement`, or with some `axes` only: error"),
      row("instrument", "turn", vector, "",
          "of a rigid grip: rotation vector about the centroid of its nodes [deg]; the ramp scales "
          "it with the displacement",
          "without `rigid`: error"),
      row("instrument", "ramp", range, "",
          "[t0, t1]: scene times of no and of full action; t0 = t1 is a step; left out: fully from "
          "the start",
          "backwards: error"),
      row("instrument", "at", vector, "", "pressure: the pressed place [mm], needed there",
          "with \"expansion\": error"),
      row("instrument", "side", word, "", "pressure: the face of the crack, needed there",
          "with \"expansion\": error", {.words = {"upper", "lower"}}),
      row("instrument", "crack", integer, "0", "pressure: number of the crack, presets first",
          "not born yet: waits, with a warning; never born: error"),
      row("instrument", "", nodes, "", "expansion: the nodes it acts on",
          "none, or with \"pressure\": error"),
      row("crack", "volume", text, "", "a named volume whose elements are the crack",
          "beside `elements`: error"),
      row("crack", "elements", ids, "",
          "its elements; []: split nodes of the mesh make the crack, or a notch that belongs to "
          "its "
          "shape",
          "an element of two cracks: error"),
      row("crack", "mouth", vector, "", "where an edge crack begins [mm]", "beside `tips`: error"),
      row("crack", "tip", vector, "", "where an edge crack ends [mm]", "length 0: error"),
      row("crack", "tips", points, "", "both ends of an internal crack [mm]", "length 0: error"),
      row("interface", "between", texts, "", "names of the two volumes",
          "not two, no such volume, the same twice, volumes that share no face: error", kRequired),
      row("interface", "strength", number, "", "largest traction in tension [MPa]",
          "0 or below: error", kRequired),
      row("interface", "energy", number, "", "that parting takes in tension [N/mm]",
          "0 or below: error", kRequired),
      row("interface", "shear_ratio", number, "1",
          "of the strength in shear to that in tension; shear takes its square times the energy",
          "0 or below: error"),
      row("destroy", "step", integer, "", "step before which they go, from 0",
          "beyond the last: error", kRequired),
      row("destroy", "volume", text, "", "a named volume", "two of these three, or none: error"),
      row("destroy", "elements", ids, "", "elements", ""),
      row("destroy", "box", points, "", "elements with centroids in [[min], [max]] (closed)", ""),
      row("nodes", "box", points, "", "nodes in [[min], [max]] (closed) [mm]",
          "minimum over maximum, no node inside: error"),
      row("nodes", "nodes", ids, "", "nodes by id", "an id that is not there: error"),
      row("nodes", "near", vector, "", "nodes at most `radius` from [x, y, z] [mm]",
          "no node there: error"),
      row("nodes", "radius", number, "", "of `near`, needed there [mm]",
          "below 0, or without `near`: error"),
      row("nodes", "surface", text, "", "nodes of a named surface", "no such surface: error"),
  };
}

SceneKey output_row() {
  return row("output", "fields", KeyType::texts, "[\"displacement\", \"stress\"]",
             "fields to store; what is left out is not stored unless the fracture model needs it "
             "(the check of a frame still takes the largest stress)",
             "another field: error");
}

SceneKey preset_row() {
  return row("material", "preset", KeyType::word, "",
             "a tissue of [tissues.md](tissues.md) with all that is known of it, `young` and "
             "`poisson` too; keys beside it override",
             "unknown: error that lists them", {.words = preset_names()});
}

SceneKey damping_row() {
  return row(
      "dynamics", "damping", KeyType::range, "[0, 0]",
      "[force per mass and velocity [1/s], stress per small-strain stiffness and strain rate "
      "[s]]",
      "below 0: error");
}

template <class Keys>
void append(std::vector<SceneKey>& all, const Keys& keys) {
  all.insert(all.end(), keys.begin(), keys.end());
}

}  // namespace

std::span<const MemberKey<Material>> material_keys() {
  static const std::vector<MemberKey<Material>> keys{
      row<&Material::young>("material", "young", "Young's modulus E [MPa]", "0 or below: error",
                            kRequired),
      row<&Material::poisson>("material", "poisson", "Poisson's ratio",
                              "not above -1 and below 0.5: error", kRequired),
      row<&Material::yield>("material", "yield", "yield stress [MPa]; left out: unbreakable",
                            "0 or below: error"),
      row<&Material::law>(
          "material", "law",
          "stress by deformation: the paper's theory of small strains, or a law of "
          "finite deformation (method.md \"Finite deformation\")",
          "a device that cannot: exit code 4",
          {.words = {"linear", "corotated", "neo-hookean", "saint-venant-kirchhoff"}}),
      row<&Material::density>("material", "density", "[t/mm^3], water 1e-9",
                              "0 or below: error; over 1e-7: warning; left out in motion or under "
                              "gravity: error"),
      row<&Material::toughness>(
          "material", "toughness",
          "K_c [MPa sqrt(mm)] at which cracks of model B grow (method.md \"Toughness\"); left out: "
          "by the yield stress (Eq. 1); without `yield` no crack starts here, cracks grow",
          "0 or below, or beside `energy`: error; a model that grows no cracks: not read, with a "
          "warning; no crack and no yield: a warning that nothing can break"),
      row<&Material::energy>("material", "energy",
                             "G_c [N/mm] in place of `toughness`, 1000 J/m^2 each: K_c = "
                             "sqrt(G_c E')",
                             "as `toughness`"),
      row<&Material::volume>(
          "material", "volume",
          "\"element\": each changes its volume by itself; \"pooled\": some 8 as one, so that "
          "nearly "
          "incompressible tissue does not lock (method.md \"Pooled volume\")",
          "\"element\" with `poisson` over 0.49: warning; \"pooled\" with a backend or route that "
          "cannot: exit code 4",
          {.words = {"element", "pooled"}}),
  };
  return keys;
}

std::span<const MemberKey<FractureOptions>> fracture_keys() {
  using F = FractureOptions;
  static const std::vector<MemberKey<F>> keys{
      row<&F::model>("fracture", "model",
                     "what breaks elements (`docs/method.md`): nothing, maximum shear stress (A), "
                     "with it stress intensity (B), largest principal stress (P)",
                     "", {.words = model_names()}),
      row<&F::alpha>("fracture", "alpha", "remaining share of a destroyed element's stiffness",
                     "not above 0 and below 1: error"),
      row<&F::yield_measure>("fracture", "yield_measure",
                             "what reaches yield: (s1 - s3)/2 or s1 - s3", "",
                             {.words = {"max_shear", "tresca"}}),
      row<&F::sigma0>("fracture", "sigma0",
                      "model B: the remote stress, a mean along the crack, that at its tip, or the "
                      "mean of the present field (method.md 5)",
                      "", {.words = {"line", "tip", "present"}}),
      row<&F::crack_length>("fracture", "crack_length",
                            "model B: a is the path's length or the tool's distance (method.md 6)",
                            "", {.words = {"path", "tool"}}),
      row<&F::sif>("fracture", "sif",
                   "model B: K by Eq. 2 or by the current field (method.md \"Field K\")", "",
                   {.words = {"formula", "field"}}),
      row<&F::crack>(
          "fracture", "crack",
          "model B: what a crack leaves, destroyed elements or a surface of faces that "
          "have opened, without lost volume (method.md \"Split cracks\")",
          "\"split\" without model B: error; a route, backend or law that cannot: exit code "
          "4; `birth` beside \"split\" is not read, with a warning",
          {.words = {"destroyed", "split"}}),
      row<&F::max_events>("fracture", "max_events", "most events of one step",
                          "below 1: error; reached: a warning", {.least = 1}),
      row<&F::plane_normal>("fracture", "plane_normal",
                            "normal of the board's plane; left out: the shortest axis of the "
                            "bounding box",
                            "zero: error"),
      row<&F::birth>(
          "fracture", "birth",
          "model B: a rupture that starts a crack takes its element alone or all through "
          "the thickness (method.md 4)",
          "", {.words = {"element", "through"}}),
      row<&F::max_new_nodes>("fracture", "max_new_nodes",
                             "crack \"split\": how many nodes may come; left out: as many as the "
                             "mesh has, at least 1,000",
                             "below 0: error; no more come: tips rest, with a warning"),
      row<&F::contact>("fracture", "contact",
                       "crack \"split\": the lips of cracks are kept apart where they close "
                       "(method.md \"Split cracks\")",
                       "true without crack \"split\": error; a backend or law that cannot: exit "
                       "code 4"),
      row<&F::averaging>("fracture", "averaging",
                         "radius of the mean stress that strength is judged by [mm]; 0: by element "
                         "(method.md \"Averaged strength\")",
                         "below 0: error"),
      row<&F::stress>("fracture", "stress",
                      "laws but linear: what criteria and results call stress, the true one or the "
                      "nominal one in the material's frame",
                      "law linear alone: not read, with a warning where it is not \"cauchy\"",
                      {.words = {"cauchy", "biot"}}),
  };
  return keys;
}

std::span<const MemberKey<SolverOptions>> solver_keys() {
  using S = SolverOptions;
  static const std::vector<MemberKey<S>> keys{
      row<&S::backend>("solver", "backend", "\"auto\", \"cpu\" or \"vulkan\"",
                       "not there: exit code 4, names what is"),
      row<&S::route>("solver", "route", "how displacements follow from loads",
                     "cannot serve the scene: error that says why",
                     {.words = {"auto", "inverse", "condensed", "factor", "cg"}}),
      row<&S::update>("solver", "update", "how a fracture enters",
                      "eager but for `inverse` in fp64: exit code 4",
                      {.words = {"auto", "eager", "deferred"}}),
      row<&S::precision>(
          "solver", "precision",
          "of a device; auto takes fp64 where `tolerance` is below 1e-4, the "
          "contrast of E over 1,000 or Poisson's ratio over 0.4999 (of pooled volume "
          "0.499)",
          "not there, or fp32 for pooled volume over 0.499: exit code 4",
          {.words = {"auto", "fp32", "fp64"}}),
      row<&S::tolerance>("solver", "tolerance", "the promised relative stress error of every frame",
                         "not above 0 and below 1: error; not kept: exit code 5"),
      row<&S::device>("solver", "device", "index among the backend's devices; left out: it chooses",
                      "below 0: error; no such device: exit code 4"),
      row<&S::prepare>("solver", "prepare",
                       "a quiet frame prepares the fractures next in line (no result changes)", ""),
      row<&S::max_ms>("solver", "max_ms",
                      "a step ends after the event that found it so long [ms], 0: none; the next "
                      "step goes on",
                      "not finite or below 0: error; reached: warning that the bits depend on the "
                      "clock"),
  };
  return keys;
}

std::span<const MemberKey<Scene>> time_keys() {
  static const std::vector<MemberKey<Scene>> keys{
      row<&Scene::steps>("time", "steps", "number of steps; scene time of step i is (i + 1)/steps",
                         "below 1: error", {.least = 1}),
  };
  return keys;
}

std::span<const MemberKey<Scene>> load_keys() {
  static const std::vector<MemberKey<Scene>> keys{
      row<&Scene::gravity>("load", "gravity",
                           "[mm/s^2]; the weight of destroyed elements stays with their nodes "
                           "while something holds them",
                           "not finite: error"),
  };
  return keys;
}

std::span<const MemberKey<Dynamics>> dynamics_keys() {
  using D = Dynamics;
  static const std::vector<MemberKey<D>> keys{
      row<&D::time_step>("dynamics", "time_step",
                         "[s]; scene time 1 is `steps` of them; the run starts undeformed, at rest",
                         "0 or below: error; over 1/100 s with a fracture model: warning",
                         kRequired),
      row<&D::max_iterations>("dynamics", "max_iterations",
                              "most applications of the base in a step, 0: as many as `tolerance` "
                              "takes",
                              "reached: the step's stress is not promised, with a warning"),
      row<&D::felt_inertia>("dynamics", "felt_inertia",
                            "whether a grip's force includes what accelerates its own nodes", ""),
  };
  return keys;
}

const std::vector<SceneKey>& scene_keys() {
  static const std::vector<SceneKey> keys = [] {
    std::vector<SceneKey> all = root_rows();
    append(all, material_keys());
    all.push_back(preset_row());
    all.push_back(fibres_row());
    append(all, fibre_rows());
    append(all, body_rows());
    append(all, fracture_keys());
    append(all, solver_keys());
    append(all, time_keys());
    all.push_back(output_row());
    append(all, load_keys());
    append(all, dynamics_keys());
    all.push_back(damping_row());
    return all;
  }();
  return keys;
}

std::vector<std::string> key_names(std::string_view table) {
  std::vector<std::string> names;
  for (const SceneKey& key : scene_keys()) {
    if (key.table != table) continue;
    if (key.type != KeyType::nodes) {
      names.emplace_back(key.name);
      continue;
    }
    const std::vector<std::string> all = key_names("nodes");
    names.insert(names.end(), all.begin(), all.end());
  }
  return names;
}

const std::vector<std::string>& key_words(std::string_view table, std::string_view name) {
  static const std::vector<std::string> none;
  for (const SceneKey& key : scene_keys()) {
    if (key.table == table && key.name == name) return key.words;
  }
  return none;
}

}  // namespace sunder
