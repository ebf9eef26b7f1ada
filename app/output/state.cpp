// SPDX-License-Identifier: Apache-2.0
#include "app/output/state.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::app {

namespace {

std::vector<LastGrowth> last_growths(const std::vector<DestroyedElement>& rows) {
  std::vector<LastGrowth> growths;
  for (const DestroyedElement& row : rows) {
    if (!row.sif) continue;
    const auto same = std::find_if(growths.begin(), growths.end(), [&](const LastGrowth& g) {
      return g.crack == row.crack && g.terms.tip == row.sif->tip;
    });
    if (same == growths.end())
      growths.push_back({row.crack, *row.sif});
    else
      same->terms = *row.sif;
  }
  return growths;
}

}  // namespace

State capture(const Simulation& simulation, int step) {
  const Scene& scene = simulation.problem().scene();
  State state;
  state.step = step;
  state.load_factor = scene_time(scene, step);
  state.displacement = simulation.displacement();
  if (simulation.backend().needs().stress) state.stress = simulation.stress();
  const auto destroyed = simulation.backend().destroyed();
  state.destroyed.assign(destroyed.begin(), destroyed.end());
  for (const DestroyedElement& row : simulation.destroyed()) {
    ++(row.lives ? state.split_count : state.destroyed_count);
  }
  state.split = split_mesh(simulation);
  state.lip_overlap = simulation.lip_overlap();
  state.cracks = simulation.cracks();
  state.growths = last_growths(simulation.destroyed());
  const std::vector<Vec3> forces = simulation.reactions();
  for (std::size_t i = 0; i < scene.instruments.size(); ++i)
    state.instruments.push_back({scene.instruments[i].name, simulation.acting_nodes(i), forces[i],
                                 std::holds_alternative<Press>(scene.instruments[i].action)});
  state.support_reaction = simulation.support_reaction();
  return state;
}

Mat3 nodal_gradient(const Mesh& mesh, Index element, std::span<const Vec3> field) {
  const auto& corners = mesh.tets[static_cast<std::size_t>(element)];
  const auto edges = [&](std::span<const Vec3> of) {
    Mat3 m;
    for (std::size_t i = 0; i < 3; ++i) {
      m.col(static_cast<Eigen::Index>(i)) =
          of[static_cast<std::size_t>(corners[i + 1])] - of[static_cast<std::size_t>(corners[0])];
    }
    return m;
  };
  return edges(field) * edges(mesh.nodes).inverse();
}

State undeformed(const Problem& problem) {
  State state;
  state.displacement.assign(problem.mesh().nodes.size(), Vec3::Zero());
  state.destroyed.assign(problem.mesh().tets.size(), 0);
  return state;
}

const Mesh& mesh_of(const Problem& problem, const State& state) {
  return state.split ? state.split->mesh : problem.mesh();
}

double scene_time(const Scene& scene, int step) {
  return static_cast<double>(step + 1) / scene.steps;
}

std::vector<double> yield_ratios(const Problem& problem, const State& state) {
  const YieldMeasure measure = strength_measure(problem.scene().fracture);
  std::vector<double> ratios(state.stress.size(), 0.0);
  for (Index e = 0; e < static_cast<Index>(ratios.size()); ++e)
    if (problem.breakable(e) && !state.destroyed[e])
      ratios[e] = problem.yield_ratio(e, state.stress[e], measure);
  return ratios;
}

std::vector<double> max_shears(const State& state) {
  std::vector<double> shears(state.stress.size());
  std::transform(state.stress.begin(), state.stress.end(), shears.begin(), max_shear);
  return shears;
}

}  // namespace sunder::app
