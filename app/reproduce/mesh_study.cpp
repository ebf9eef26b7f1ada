// SPDX-License-Identifier: Apache-2.0
// How much of experiment 2 belongs to the mesh.
#include <cmath>
#include <limits>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/notch_mesh.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kPull = 42;     // N, of scene notch-b
constexpr double kStopped = 10;  // mm: a crack that long has left the notch behind

struct Board {
  std::string name;
  NotchMesh mesh;
  int events_per_step;  ///< the advance of an event is proportional to h
  bool refinement;      ///< one of the series 1, 4, 16 times as many
};

/// Element sizes that give the same number by three meshers (1954, 1940, 1937 with Debian 12's
/// gmsh), and 4 and 16 times as many (7,823 and 31,785).
std::vector<Board> boards(bool quick) {
  std::vector<Board> all = {{"1x Delaunay", {3.939, 4.04, 5}, 1, true},
                            {"1x Frontal", {3.838, 4.04, 6}, 1, false},
                            {"4x", {1.714, 4.04, 5}, 2, true}};
  if (quick) return all;
  all.push_back({"1x MeshAdapt", {3.294, 4.04, 1}, 1, false});
  all.push_back({"16x", {0.994, 4.04, 5}, 4, true});
  return all;
}

struct Measured {
  std::string board, by;
  bool refinement = false;
  Index tets = 0;
  double h = 0;
  std::optional<CriticalLoad> critical;
  GrownPath path;
  std::optional<double> yield_ahead;  ///< of the live element nearest to the tip at the end [MPa]
};

std::optional<double> yield_ahead(const RunResult& run) {
  if (run.cracks.empty()) return std::nullopt;
  const Vec2 tip = run.cracks.front().tips.front().position;
  const Mesh& mesh = run.problem->mesh();
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<double> yield;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (run.last.destroyed[e] || !run.problem->breakable(e)) continue;
    Vec3 centroid = Vec3::Zero();
    for (const Index node : mesh.tets[e]) centroid += mesh.nodes[node] / 4;
    const double away = (run.plane.project(centroid) - tip).norm();
    if (!(away < nearest)) continue;
    nearest = away;
    yield = run.problem->yield(e);
  }
  return yield;
}

std::vector<Measured> measure(const Laboratory& lab, const Board& board) {
  const auto mesh = lab.notch(board.mesh);
  std::vector<Measured> rows;
  for (const KChoice& k : both_k()) {
    lab.tell("mesh sensitivity: " + board.name + ", " + k.name);
    RunPlan plan{"notch-b", {k.override}, mesh, 1, {}};
    Measured row{
        board.name, k.name, board.refinement, mesh->tet_count(), 0, critical_growth(lab, plan),
        {},         {}};
    plan.overrides.push_back("fracture.max_events=" + std::to_string(board.events_per_step));
    const RunResult run = lab.run(plan);
    row.h = run.plane.edge_length;
    row.path = preset_path(run);
    row.yield_ahead = yield_ahead(run);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<double> force(const Measured& row) {
  return row.critical ? std::optional(row.critical->factor * kPull) : std::nullopt;
}

/// K per newton of pull [MPa sqrt(mm)/N] that drives the first growth.
std::optional<double> k_per_newton(const Measured& row) {
  if (!row.critical || !row.critical->sif) return std::nullopt;
  return row.critical->sif->k / (row.critical->factor * kPull);
}

/// The finest mesh of the refinement series, same K.
const Measured* finest(const std::vector<Measured>& rows, const std::string& by) {
  const Measured* best = nullptr;
  for (const Measured& row : rows)
    if (row.by == by && row.refinement && (!best || row.tets > best->tets)) best = &row;
  return best;
}

DataTable table_of(const std::vector<Measured>& rows) {
  DataTable table{
      "mesh-sensitivity",
      "Deviation: height of the path against the finest mesh's, same K, over the length "
      "that both have.",
      {"mesh", "K", "elements", "h [mm]", "critical force [N]", "force/sqrt(h) [N/sqrt(mm)]",
       "K/force [MPa sqrt(mm)/N]", "first growth [deg]", "mean deviation [mm]",
       "largest deviation [mm]", "common length [mm]", "grown [mm]",
       "yield ahead at the end [MPa]"},
      {},
      true};
  for (const Measured& row : rows) {
    const Measured* reference = finest(rows, row.by);
    const bool compared = reference && reference != &row && row.path.points.size() > 1;
    const Deviation apart = compared ? deviation(row.path, reference->path) : Deviation{};
    const auto part = [&](double value) { return compared ? cell(value) : std::string(); };
    const auto f = force(row);
    table.rows.push_back({row.board, row.by, std::to_string(row.tets), cell(row.h), cell(f),
                          cell(f ? std::optional(*f / std::sqrt(row.h)) : std::nullopt),
                          cell(k_per_newton(row)),
                          cell(row.critical ? std::optional(row.critical->rise_deg) : std::nullopt),
                          part(apart.mean), part(apart.largest), part(apart.common),
                          cell(row.path.advance()), cell(row.yield_ahead)});
  }
  return table;
}

/// Exponent of the critical force over h in the refinement series.
std::string exponent(const std::vector<Measured>& rows, const KChoice& k) {
  std::vector<Vec2> points;
  for (const Measured& row : rows)
    if (row.by == k.name && row.refinement && force(row)) points.emplace_back(row.h, *force(row));
  if (points.size() < 2) return k.name + ": no critical force on two meshes.";
  return k.name + ": critical force ~ h^" + rounded(power(points), 2) +
         " over the refinement series.";
}

Drawing paths(const std::vector<Measured>& rows, const KChoice& k, const std::string& name) {
  std::vector<ChartSeries> series;
  for (const Measured& row : rows)
    if (row.by == k.name) series.push_back({row.board, row.path.points});
  return chart_drawing(name, "Paths of the notch's crack on all meshes, " + k.name + ".", series,
                       {"distance along the notch's direction [mm]", "height [mm]"});
}

DataTable path_table(const std::vector<Measured>& rows) {
  DataTable table{"mesh-sensitivity-paths",
                  "Paths: distance along the notch's direction and height [mm].",
                  {"mesh", "K", "distance", "height"},
                  {},
                  false};
  for (const Measured& row : rows)
    for (const Vec2& p : row.path.points)
      table.rows.push_back({row.board, row.by, cell(p.x()), cell(p.y())});
  return table;
}

}  // namespace

Chapter mesh_study(const Laboratory& lab, const Effort& effort) {
  std::vector<Measured> rows;
  for (const Board& board : boards(effort.quick))
    for (Measured& row : measure(lab, board)) rows.push_back(std::move(row));
  Chapter chapter{
      "mesh-sensitivity",
      "Sensitivity to the mesh",
      "Scene notch-b on the notched board of 1954 elements meshed by three algorithms of "
      "gmsh, and with about 4 and 16 times as many elements; events per step grow with "
      "1/h. Critical force: the pull at which the crack grows first.",
      {},
      {paths(rows, both_k()[0], "mesh-sensitivity-formula"),
       paths(rows, both_k()[1], "mesh-sensitivity-field")},
      {table_of(rows), path_table(rows)},
      {}};
  for (const KChoice& k : both_k()) chapter.findings.push_back(exponent(rows, k));
  for (const Measured& row : rows)
    if (row.path.advance() < kStopped && row.path.points.size() > 1)
      chapter.findings.push_back(
          row.board + ", " + row.by + ": the crack stops after " + rounded(row.path.advance(), 3) +
          " mm, " + rounded(-row.path.points.back().y(), 2) +
          " mm below the border of the tissues, before elements with a yield stress of " +
          (row.yield_ahead ? rounded(*row.yield_ahead, 2) : std::string("?")) +
          " MPa: in the lower tissue Eq. 1's reach is a quarter of that in the upper one.");
  chapter.findings.push_back(
      "The criterion itself asks for K ~ sqrt(h): a crack grows when Eq. 1's reach passes the next "
      "element, at least h/2 away, so r_e = K^2/(2 pi yield^2) >= h/2. The mesh is the material's "
      "length. K per force is what should not depend on the mesh.");
  return chapter;
}

}  // namespace sunder::app::reproduce
