// SPDX-License-Identifier: Apache-2.0
#include "app/output/summary.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "app/output/text.hpp"
#include "sunder/board_plane.hpp"
#include "sunder/parted_interfaces.hpp"
#include "sunder/scene_keys.hpp"

namespace sunder::app {
namespace {

using Json = nlohmann::ordered_json;

template <class Vector>
Json array(const Vector& v) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(v[i]);
  return out;
}

Json points(std::span<const Vec2> path) {
  Json out = Json::array();
  for (const Vec2& p : path) out.push_back(array(p));
  return out;
}

/// As points of space at mid-thickness.
Json lifted(const BoardPlane& plane, std::span<const Vec2> path) {
  Json out = Json::array();
  for (const Vec2& p : path) out.push_back(array(plane.lift(p)));
  return out;
}

Json destroyed_ids(const RunRecord& run) {
  Json out = Json::array();
  for (const DestroyedElement& d : run.destroyed) {
    if (!d.lives) out.push_back(d.element);
  }
  return out;
}

Json first_rupture(const RunRecord& run) {
  const DestroyedElement* first = run.first_rupture();
  if (!first) return nullptr;
  Json out = {{"step", first->step},
              {"event", first->event},
              {"element", first->element == kNone ? Json(nullptr) : Json(first->element)},
              {"criterion", to_string(first->cause)},
              {"load_factor", first->load_factor}};
  if (const auto& state = run.at_first_rupture) {
    out["displacement_max"] = state->displacement_max;
    const auto& d = state->deformation;
    out["strain"] = d ? Json(d->strain) : Json(nullptr);
    out["rotation_deg"] = d ? Json(d->rotation_deg) : Json(nullptr);
  }
  return out;
}

Json motion(const std::optional<MotionState>& state) {
  if (!state) return nullptr;
  return {{"time", state->time},
          {"kinetic", state->kinetic},
          {"strain_energy", state->strain_energy},
          {"work", state->work},
          {"dissipated",
           {{"damping", state->damped},
            {"scheme", state->scheme},
            {"broken", state->broken},
            {"unsolved", state->unsolved}}},
          {"momentum", array(state->momentum)},
          {"angular_momentum", array(state->angular_momentum)}};
}

/// What this run calls stress; null: at small strain all are one.
Json stress_measure(const Problem& problem) {
  if (!problem.finite()) return nullptr;
  return key_words("fracture", "stress")[static_cast<std::size_t>(problem.scene().fracture.stress)];
}

Json largest(const RunRecord& run) {
  const auto d = run.largest();
  if (!d) return nullptr;
  return {{"strain", d->strain}, {"rotation_deg", d->rotation_deg}, {"inverted", d->inverted}};
}

Json cracks(const RunRecord& run) {
  Json out = Json::array();
  if (run.cracks.empty()) return out;
  const Problem& problem = run.problem;
  const BoardPlane plane = board_plane(problem.mesh(), problem.scene().fracture.plane_normal);
  for (const Crack& crack : run.cracks) {
    std::vector<Vec2> tips;
    for (const CrackTip& tip : crack.tips) tips.push_back(tip.position);
    out.push_back({{"id", crack.id},
                   {"kind", name_of(crack.kind)},
                   {"mouth", crack.mouth ? array(*crack.mouth) : Json(nullptr)},
                   {"tips", points(tips)},
                   {"length", crack.length},
                   {"path", points(crack.path)},
                   {"mouth_xyz", crack.mouth ? array(plane.lift(*crack.mouth)) : Json(nullptr)},
                   {"tips_xyz", lifted(plane, tips)},
                   {"path_xyz", lifted(plane, crack.path)}});
  }
  return out;
}

/// K_c where cracks could grow on, and in which state a G_c was made K_c there.
Json toughness(const RunRecord& run) {
  Json out = Json::array();
  for (const TipState& tip : run.tips) {
    if (!tip.toughness) continue;
    out.push_back({{"crack", tip.crack},
                   {"tip", tip.tip},
                   {"toughness", *tip.toughness},
                   {"state", std::string(tip.toughness_state)}});
  }
  return out;
}

Json reactions(const RunRecord& run) {
  Json out = Json::object();
  for (const InstrumentState& tool : run.last.instruments) out[tool.name] = array(tool.force);
  return out;
}

Json timings(const RunRecord& run) {
  Json out = Json::object();
  for (const Stage& stage : stages()) {
    const TimeStatistics t = statistics(run.steps, stage);
    out[stage.name] = {
        {"min", t.min}, {"median", t.median}, {"p99", t.p99}, {"max", t.max}, {"sum", t.sum}};
  }
  return out;
}

/// What has parted of each, and the energy that it took.
Json interfaces(const RunRecord& run) {
  Json out = Json::array();
  const Interfaces* all = run.problem.interfaces();
  if (!all) return out;
  const std::vector<PartedInterface> parted = parted_interfaces(*all, run.destroyed);
  for (std::size_t i = 0; i < parted.size(); ++i) {
    const Interface& of = run.problem.scene().interfaces[i];
    const InterfaceLayer& layer = all->layers()[i];
    out.push_back({{"between", {of.between[0], of.between[1]}},
                   {"strength", of.strength},
                   {"energy", of.energy},
                   {"shear_ratio", of.shear_ratio},
                   {"stiffness", layer.mu / layer.thickness},
                   {"opening", layer.opening},
                   {"thickness", layer.thickness},
                   {"area", layer.area},
                   {"parted", parted[i].area},
                   {"spent", parted[i].energy}});
  }
  return out;
}

/// What cracks of this run leave, and how much of it.
void add_split(const RunRecord& run, Json& out) {
  const Scene& scene = run.problem.scene();
  const bool split = cracks_split(scene);
  const SplitMesh* mesh = run.last.split.get();
  out["crack"] = key_words("fracture", "crack")[static_cast<std::size_t>(scene.fracture.crack)];
  out["crack_area"] = !split ? Json(nullptr) : Json(mesh ? crack_area(*mesh) : 0.0);
  out["lip_overlap"] = split ? Json(run.last.lip_overlap) : Json(nullptr);
  out["new_nodes"] = mesh ? mesh->mesh.node_count() - run.problem.node_count() : 0;
}

Json tree(const RunRecord& run) {
  const Problem& problem = run.problem;
  const StepReport last = run.last_report();
  Json out;
  out["title"] = problem.scene().title;
  out["mesh"] = {{"nodes", problem.node_count()},
                 {"tets", problem.tet_count()},
                 {"free_dofs", problem.dof_count()}};
  out["device"] = {{"name", run.backend.device},
                   {"driver", run.backend.driver},
                   {"backend", run.backend.backend},
                   {"precision", run.backend.precision}};
  out["route"] = {{"name", run.backend.route},
                  {"update", run.backend.update},
                  {"why", run.backend.why},
                  {"left_out", run.left_out}};
  out["compliance"] = last.compliance;
  out["residual"] = last.residual;
  out["error"] = last.error;
  out["destroyed"] = destroyed_ids(run);
  out["first_rupture"] = first_rupture(run);
  out["cracks"] = cracks(run);
  out["reactions"] = reactions(run);
  out["supports"] = array(run.last.support_reaction);
  out["memory_bytes"] = run.backend.memory_bytes;
  out["timings_ms"] = timings(run);
  out["warnings"] = run.warnings;
  out["model"] = name_of(problem.scene().fracture.model);
  out["steps"] = problem.scene().steps;
  out["steps_done"] = run.steps.size();
  out["events"] = run.event_count();
  out["max_yield_ratio"] = last.max_yield_ratio;
  out["interrupted"] = run.interrupted;
  if (run.preparation) {
    out["preparation"] = {{"destroyed", run.preparation->destroyed},
                          {"predicted", run.preparation->predicted},
                          {"spent_ms", run.preparation->spent_ms},
                          {"saved_ms", run.preparation->saved_ms}};
  }
  out["failure"] = run.failure ? Json(*run.failure) : Json(nullptr);
  out["largest"] = largest(run);
  out["volume_lost"] = run.volume_lost();
  out["law"] = problem.law();
  out["stress_measure"] = stress_measure(problem);
  out["motion"] = motion(last.motion);
  out["toughness"] = toughness(run);
  add_split(run, out);
  out["interfaces"] = interfaces(run);
  return out;
}

bool is_flat(const Json& value) {
  for (const auto& item : value)
    if (item.is_structured()) return false;
  return true;
}

/// The library's own writer gives round-trip but not always shortest decimals.
void write(const Json& value, int depth, std::string& out) {
  if (value.is_number_float()) {
    const double x = value.get<double>();
    out += std::isfinite(x) ? number(x) : "null";
    return;
  }
  if (!value.is_structured()) {
    out += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const bool object = value.is_object(), inline_items = !object && is_flat(value);
  const std::string indent(2 * (depth + 1), ' ');
  bool first = true;
  out += object ? "{" : "[";
  for (const auto& item : value.items()) {
    if (!first) out += inline_items ? ", " : ",";
    first = false;
    if (!inline_items) out += "\n" + indent;
    if (object) out += Json(item.key()).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
    write(item.value(), depth + 1, out);
  }
  if (!inline_items && !first) out += "\n" + indent.substr(2);
  out += object ? "}" : "]";
}

}  // namespace

std::string summary_json(const RunRecord& run) {
  std::string out;
  write(tree(run), 0, out);
  return out + "\n";
}

}  // namespace sunder::app
