// SPDX-License-Identifier: Apache-2.0
// From arrays to a torn board, in C++20.   c++ -std=c++20 hello.cpp $(pkg-config --cflags --libs
// sunder-cpp)
#include <array>
#include <cstdio>
#include <memory>
#include <sunder/backends.hpp>
#include <sunder/error.hpp>
#include <sunder/simulation.hpp>

namespace {

constexpr int kCells = 10, kRow = kCells + 1;

// 10 x 10 x 1 mm: one layer of cubes, each cut into six tetrahedra round its diagonal 0-7.
sunder::Mesh make_board() {
  constexpr int kCut[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  sunder::Mesh mesh;
  for (int n = 0; n < 2 * kRow * kRow; ++n) {
    mesh.nodes.emplace_back(n % kRow, n / kRow % kRow, n / (kRow * kRow));
  }
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const int first = cell % kCells + cell / kCells * kRow;
    for (const auto& cut : kCut) {
      std::array<sunder::Index, 4> tet{};
      for (int k = 0; k < 4; ++k) {
        tet[k] = first + cut[k] % 2 + cut[k] / 2 % 2 * kRow + cut[k] / 4 * kRow * kRow;
      }
      mesh.tets.push_back(tet);
    }
  }
  mesh.volumes = {{"tissue", 1}};
  mesh.volume_of.assign(mesh.tets.size(), 0);
  return mesh;
}

sunder::Scene make_scene() {
  sunder::Scene scene;
  scene.source = "hello";
  scene.mesh = make_board();
  scene.materials["tissue"] = {5.0, 0.4, 2.0};  // MPa
  scene.supports.push_back({sunder::Box{{0, 10, 0}, {10, 10, 1}}, {}});
  const sunder::Pull pull{sunder::Box{{10, 0, 0}, {10, 0, 1}}, {0, -2.4, 0}};  // N
  scene.instruments.push_back({"forceps", pull, sunder::Ramp{0, 1}});
  // Model B takes the body for a flat board of even thickness. This one is: 10 x 10 x 1 mm. For any
  // other shape take FractureModel::a (docs/limits.md).
  scene.fracture.model = sunder::FractureModel::b;
  scene.steps = 20;
  return scene;
}

}  // namespace

int main() try {
  auto problem = std::make_shared<const sunder::Problem>(make_scene());
  auto created = sunder::create_backend(problem, sunder::needs_of(*problem));
  sunder::Simulation simulation(problem, std::move(created.backend));
  while (!simulation.done()) {
    const sunder::StepReport step = simulation.step();
    std::printf("step %2d: %.2f N, %2d destroyed, %.3f ms\n", step.step, 2.4 * step.load_factor,
                step.destroyed, step.times.total);
  }
  const sunder::DestroyedElement& first = simulation.destroyed().at(0);
  std::printf("element %d broke first: %.2f times its yield stress\n", first.element,
              first.ratio.value_or(0));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
