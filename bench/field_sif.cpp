// SPDX-License-Identifier: Apache-2.0
// Time to decide which element ruptures on the notched board of 1954 elements, model B, K by the
// formula or from the field (the paper's Table 3: 2.86 s on a 3.2 GHz Xeon, of which 2.81 s stress
// intensity). One thread; the load is low enough that the decision is "none", so that each pass
// decides the same: K and direction of the tip, band, walk, comparison with the largest stress.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "fracture/criterion.hpp"
#include "sunder/simulation.hpp"
#include "support/msh_reader.hpp"

namespace sunder {
namespace {

Scene notched_board(SifSource sif) {
  Scene scene;
  scene.mesh = test::read_msh22(std::string(SUNDER_SCENES) + "/meshes/board1954_notch.msh");
  scene.materials["upper"] = {5, 0.4, 2.0};
  scene.materials["lower"] = {8, 0.4, 4.0};
  scene.materials["preset-crack"] = {5, 0.4, 2.0};
  scene.materials["top-frame"] = scene.materials["bottom-frame"] = {500, 0.4, {}};
  Support support;
  support.nodes = Box{{-1, 49.999, -1}, {51, 50.001, 3}};
  scene.supports.push_back(support);
  Instrument pull;
  pull.name = "right forceps";
  pull.action = Pull{Box{{49.999, -0.001, -1}, {50.001, 0.001, 3}}, Vec3(0, -5, 0)};
  scene.instruments.push_back(pull);
  PresetCrack notch;
  notch.elements = VolumeName{"preset-crack"};
  notch.mouth = Vec3(50, 25, 1);
  notch.tips = {Vec3(45.96, 25, 1)};
  scene.cracks.push_back(notch);
  scene.fracture.model = FractureModel::b;
  scene.fracture.sif = sif;
  scene.solver.backend = "cpu";
  return scene;
}

void decide(benchmark::State& bench, SifSource sif) {
  auto problem = std::make_shared<const Problem>(notched_board(sif));
  auto backend = cpu_reference::create(problem, needs_of(*problem));
  const auto criterion = make_criterion(*problem);
  std::vector<Index> preset;
  for (const DestroyedElement& row : criterion->preset().elements) preset.push_back(row.element);
  backend->destroy(preset);

  Load load;
  const auto& nodes = problem->instrument_nodes()[0].nodes;
  std::vector<NodalForce> forces;
  for (Index n : nodes) {
    forces.push_back({n, Vec3(0, -5.0 / static_cast<double>(nodes.size()), 0)});
    load.force_dofs.push_back(problem->dof(n, 1));
    load.forces.push_back(forces.back().force.y());
  }
  backend->set_load(load);
  backend->solve();
  std::vector<double> pristine(3 * problem->mesh().nodes.size());
  backend->solve_pristine(load, pristine);
  const FractureState state{
      *problem,
      backend->destroyed(),
      backend->stress(),
      [&](Index e) { return backend->read_stress(e); },
      [&] { return std::span<const double>(pristine); },
      Vec3(0, -5, 0),
      {},
      [&](std::span<const Index> ids, std::span<Vec3> u) { backend->read_displacement(ids, u); },
      [&] { return forces; }};
  for (auto _ : bench) {
    const Decision decision = criterion->decide(state);
    if (!decision.elements.empty()) bench.SkipWithError("the board breaks under this load");
    benchmark::DoNotOptimize(decision.elements.data());
  }
}

BENCHMARK_CAPTURE(decide, formula, SifSource::formula)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(decide, field, SifSource::field)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace sunder
