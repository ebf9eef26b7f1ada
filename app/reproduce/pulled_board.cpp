// SPDX-License-Identifier: Apache-2.0
// Experiment 1, and Fig. 5(a), which is the last step of its Fig. 4(b).
#include <algorithm>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/models.hpp"
#include "app/reproduce/statements.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kPull = 98;          // N, of scene board-pull-b
constexpr double kFirstRupture = 94;  // N, from which the scene's pull was chosen
constexpr double kGrip = 36;          // mm
constexpr const char* kUpThenDown = "The crack runs first up, then down (Fig. 5(a)).";

/// The pulled board in another mesh, by force or by a grip.
struct Variant {
  std::string name;
  std::optional<BoardMesh> mesh;
  bool grip = false;
  int events_per_step = 1;  ///< an event's advance is proportional to h
};

std::vector<Variant> variants(bool quick) {
  std::vector<Variant> all = {{"36 mm by a grip", {}, true, 1}};
  if (quick) return all;
  all.push_back({"Frontal", BoardMesh{3.75, 6}, false, 1});
  all.push_back({"MeshAdapt", BoardMesh{3.2, 1}, false, 1});
  all.push_back({"finer", BoardMesh{2.6, 5}, false, 2});
  all.push_back({"finest", BoardMesh{1.86, 5}, false, 2});
  return all;
}

std::optional<double> share_of_growth(const std::vector<DestroyedElement>& rows) {
  if (rows.empty()) return std::nullopt;
  const auto grown = std::count_if(rows.begin(), rows.end(), [](const DestroyedElement& row) {
    return row.cause == Cause::sif;
  });
  return static_cast<double>(grown) / static_cast<double>(rows.size());
}

std::optional<double> connected(const RunResult& run) {
  const auto rows = run.fractures();
  if (rows.empty()) return std::nullopt;
  return connected_share(run.problem->mesh(), rows);
}

using PeakDistance = std::optional<double> (*)(const RunResult&, const State&);

std::vector<std::optional<double>> peaks(const RunResult& run, PeakDistance distance) {
  std::vector<std::optional<double>> distances;
  for (const State& state : run.snapshots) distances.push_back(distance(run, state));
  if (distances.empty() && !run.fractures().empty()) distances.push_back(distance(run, run.last));
  return distances;
}

std::optional<Turns> turns_of_born(const RunResult& run) {
  const auto path = born_path(run);
  if (!path || path->points.size() < 2) return std::nullopt;
  return turns_of(*path);
}

/// Pulled as far above its own first rupture as the scene's board is above its.
RunResult run_variant(const Laboratory& lab, const Variant& variant, const KChoice& k) {
  RunPlan plan{"board-pull-b", {k.override}, nullptr, 1, {}};
  if (variant.grip) plan.grip = kGrip;
  if (variant.mesh) {
    plan.mesh = lab.board(*variant.mesh);
    const auto first = critical_load(lab, plan);
    if (first) plan.load = first->factor * kPull / kFirstRupture;
  }
  plan.overrides.push_back("fracture.max_events=" + std::to_string(variant.events_per_step));
  return lab.run(plan);
}

std::vector<std::string> turns_row(const std::string& name, const KChoice& k,
                                   const RunResult& run) {
  const double h = run.plane.edge_length;
  const auto turns = turns_of_born(run);
  const auto part = [&](double value) { return turns ? cell(value) : std::string(); };
  const Turns t = turns.value_or(Turns{});
  return {name,
          k.name,
          std::to_string(run.problem->tet_count()),
          cell(h),
          part(t.rise_deg),
          part(t.fall_deg),
          part(t.highest),
          part(t.highest / h),
          part(t.end),
          to_string(judge_up_then_down(turns, h).verdict)};
}

/// "+6.5 / -10.4 deg, top 0.64 h"
std::string turns_text(const RunResult& run) {
  const auto turns = turns_of_born(run);
  if (!turns) return "no crack from the rim";
  return "+" + rounded(turns->rise_deg, 3) + " / " + rounded(turns->fall_deg, 3) + " deg, top " +
         rounded(turns->highest / run.plane.edge_length, 2) + " h";
}

/// Fig. 5(a): the statement on the scene's board, and what a grip and other meshes make of it.
void judge_turns(const Laboratory& lab, const Effort& effort, const std::vector<Model>& models,
                 Chapter& chapter) {
  DataTable table{"experiment-1-up-then-down",
                  "First up, then down: the path of the crack that is born at the rim, heights "
                  "above its mouth.",
                  {"run", "K", "elements", "h [mm]", "slope to the highest point [deg]",
                   "slope from there [deg]", "highest point [mm]", "highest point [h]",
                   "height at the end [mm]", "verdict"},
                  {},
                  true};
  for (std::size_t i = 0; i < both_k().size(); ++i) {
    const KChoice& k = both_k()[i];
    const RunResult& scene = models[i + 1].run;
    chapter.statements.push_back(up_then_down(scene, k));
    table.rows.push_back(turns_row("98 N, the scene", k, scene));
    std::string text = k.name + ", up then down: the scene " + turns_text(scene);
    int meshes = 0, seen = 0;
    for (const Variant& variant : variants(effort.quick)) {
      const RunResult run = run_variant(lab, variant, k);
      table.rows.push_back(turns_row(variant.name, k, run));
      text += "; " + variant.name + " (" + std::to_string(run.problem->tet_count()) +
              " elements): " + turns_text(run);
      const auto turns = turns_of_born(run);
      meshes += variant.mesh ? 1 : 0;
      seen += variant.mesh && turns && goes_up_then_down(*turns) ? 1 : 0;
    }
    if (meshes > 0)
      text += ". Of " + std::to_string(meshes) + " other meshes " + std::to_string(seen) +
              (seen == 1 ? " shows" : " show") + " it" +
              (seen < meshes ? ": it depends on the mesh" : "");
    chapter.findings.push_back(text + ".");
  }
  chapter.tables.push_back(table);
}

DataTable first_ruptures(const Laboratory& lab) {
  DataTable first{"experiment-1-first-rupture",
                  "Force at which the first element ruptures.",
                  {"pulling points", "force each [N]", "force in all [N]"},
                  {},
                  true};
  for (const auto& [name, scene, points] :
       {std::tuple{"lower right", "board-pull-b", 1.0},
        std::tuple{"lower left and right", "board-pull-two-points-b", 2.0}}) {
    const auto force = critical_force(lab, scene, {}, false);
    first.rows.push_back(
        {name, cell(force ? std::optional(*force / points) : std::nullopt), cell(force)});
  }
  return first;
}

}  // namespace

std::vector<Statement> pulled_statements(const std::vector<Model>& models) {
  const std::string words = "dynamic definition of the direction of rupture progression";
  const auto a = models[0].run.fractures();
  std::vector<Statement> statements;
  statements.push_back(
      {"1b", "The stress concentrates where the tissue is torn.", "model A",
       judge_peak_at_tip(peaks(models[0].run, peak_to_damage), "the nearest destroyed element"),
       words});
  for (std::size_t i = 1; i < models.size(); ++i) {
    const RunResult& run = models[i].run;
    const auto rows = run.fractures();
    const std::string by = both_k()[i - 1].name;
    statements.push_back(
        {"1a", "With B a rupture becomes a crack, and the fractures that follow belong to it.", by,
         judge_one_crack({connected(run), share_of_growth(rows)}), words});
    statements.push_back({"1b", "With B the stress concentrates at the crack's tip.", by,
                          judge_peak_at_tip(peaks(run, peak_to_tip)), words});
    const std::size_t count = std::min({a.size(), rows.size(), std::size_t{40}});
    statements.push_back(
        {"1c", "A and B destroy different elements.", by,
         judge_models_differ(count == 0 ? std::optional<double>() : overlap(a, rows, count)),
         words});
  }
  return statements;
}

Statement up_then_down(const RunResult& run, const KChoice& k) {
  return {"2a", kUpThenDown, k.name, judge_up_then_down(turns_of_born(run), run.plane.edge_length),
          "the simulated crack progression"};
}

Chapter pulled_board(const Laboratory& lab, const Effort& effort) {
  lab.tell("experiment 1: board pulled at its corner");
  const std::vector<Model> models = run_models(lab, "board-pull");
  Chapter chapter{
      "experiment-1",
      "Experiment 1 (Fig. 4 and 5(a)): board pulled at its lower right corner",
      "Scenes board-pull-a and board-pull-b: 1954 tetrahedra, 98 N. Model B lets a new "
      "crack go through the thickness (birth = \"through\"); K from the paper's formula "
      "and K measured from the field. Fig. 5(a) is the last step of Fig. 4(b): the un-notched "
      "board by model B.",
      {},
      {},
      {},
      {}};
  chapter.statements = pulled_statements(models);
  judge_turns(lab, effort, models, chapter);
  chapter.tables.push_back(first_ruptures(lab));
  chapter.tables.push_back(events_table("experiment-1-fractures", models));
  chapter.drawings.push_back(
      {"experiment-1",
       "Stress and destroyed elements after 5, 10, 20 and 40 fractures, or at the "
       "first event beyond; one event of B may pass two of these. t: scene "
       "time; x: displacements drawn smaller than they are.",
       picture("Board pulled at its lower right corner", models)});
  return chapter;
}

}  // namespace sunder::app::reproduce
