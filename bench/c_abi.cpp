// SPDX-License-Identifier: Apache-2.0
// What the C interface costs: the same step of the same scene through it and through C++, turn by
// turn in one process. bench/run adds `share`: the least time through C over the least time through
// C++, minus 1.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "sunder/sunder.h"
#include "support/structured_board.hpp"

namespace {

using namespace sunder;
using Clock = std::chrono::steady_clock;

constexpr std::int32_t kSteps = 2147483647;
const Box kTop{Vec3(-1, 9.99, -1), Vec3(11, 10.01, 2)};
const Box kCorner{Vec3(9.99, -0.01, -1), Vec3(10.01, 0.01, 2)};

std::unique_ptr<Simulation> by_cpp(const Mesh& mesh) {
  Scene scene;
  scene.mesh = mesh;
  scene.materials["board"] = {5.0, 0.4, 1e6};
  scene.supports.push_back({kTop, Axes{7}});
  scene.instruments.push_back({"forceps", Pull{kCorner, Vec3(0, -1, 0)}, {}});
  scene.fracture.model = FractureModel::b;
  scene.solver.backend = "cpu";
  scene.steps = kSteps;
  auto problem = std::make_shared<const Problem>(std::move(scene));
  auto created = create_backend(problem, needs_of(*problem));
  return std::make_unique<Simulation>(problem, std::move(created.backend));
}

sunder_selection in(const Box& box) {
  sunder_selection s{};
  s.kind = SUNDER_SELECT_BOX;
  std::copy_n(box.min.data(), 3, s.min);
  std::copy_n(box.max.data(), 3, s.max);
  return s;
}

sunder_simulation by_c(const Mesh& mesh) {
  std::vector<double> nodes;
  std::vector<std::int32_t> tets;
  for (const Vec3& x : mesh.nodes) nodes.insert(nodes.end(), x.data(), x.data() + 3);
  for (const auto& t : mesh.tets) tets.insert(tets.end(), t.begin(), t.end());
  sunder_scene scene{};
  sunder_scene_create(&scene);
  sunder_scene_set_mesh(scene, nodes.data(), nodes.size(), tets.data(), tets.size(), nullptr, 0);
  sunder_material tissue;
  sunder_material_init(&tissue);
  tissue.young = 5;
  tissue.poisson = 0.4;
  tissue.yield = 1e6;
  sunder_scene_add_material(scene, &tissue, nullptr);
  sunder_support top;
  sunder_support_init(&top);
  top.nodes = in(kTop);
  sunder_scene_add_support(scene, &top);
  sunder_instrument pull;
  sunder_instrument_init(&pull);
  pull.nodes = in(kCorner);
  pull.value[1] = -1;
  sunder_scene_add_instrument(scene, &pull, nullptr);
  sunder_fracture_options fracture;
  sunder_fracture_options_init(&fracture);
  fracture.model = SUNDER_FRACTURE_B;
  sunder_scene_set_fracture(scene, &fracture);
  sunder_solver_options solver;
  sunder_solver_options_init(&solver);
  solver.backend = SUNDER_BACKEND_CPU;
  sunder_scene_set_solver(scene, &solver);
  sunder_scene_set_steps(scene, kSteps);
  sunder_simulation simulation{};
  sunder_simulation_create(scene, nullptr, &simulation);
  sunder_scene_destroy(scene);
  return simulation;
}

/// One frame as a trainer has it: drive the instrument, step, take the displacement.
template <class Body>
double microseconds(Body&& body) {
  const auto start = Clock::now();
  body();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

void frame(benchmark::State& state) {
  const auto cells = static_cast<Index>(state.range(0));
  const Mesh mesh = test::structured_board({cells, cells, 1, 10, 10, 1});
  const auto cpp = by_cpp(mesh);
  const sunder_simulation c = by_c(mesh);
  std::vector<double> u(3 * mesh.nodes.size());
  sunder_step report{};
  report.struct_size = sizeof report;
  double least_cpp = 1e9, least_c = 1e9, force = 1;
  for (auto _ : state) {
    force = -force;
    least_cpp = std::min(least_cpp, microseconds([&] {
                           cpp->drive(0, Vec3(0, force, 0));
                           benchmark::DoNotOptimize(cpp->step());
                           cpp->backend().read_displacement(u);
                         }));
    const double value[3] = {0, force, 0};
    least_c = std::min(least_c, microseconds([&] {
                         if (sunder_simulation_drive(c, 0, value) != SUNDER_OK ||
                             sunder_simulation_step(c, &report) != SUNDER_OK ||
                             sunder_simulation_displacement(c, u.data(), u.size()) != SUNDER_OK) {
                           state.SkipWithError(sunder_last_error());
                         }
                       }));
  }
  sunder_simulation_destroy(c);
  state.counters["us_cpp"] = least_cpp;
  state.counters["us_c"] = least_c;
}
BENCHMARK(frame)->Arg(4)->Arg(18)->Iterations(3000);

}  // namespace
