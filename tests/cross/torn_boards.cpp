// SPDX-License-Identifier: Apache-2.0
// Boards torn by every way of computing, as text: each rupture in order, and where the nodes are at
// the end to the last bit. tests/cross/compare.py holds one machine's text against another's.
#include <cstdio>
#include <functional>
#include <string>

#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

constexpr std::size_t kMost = 60;  // ruptures

Scene board(Route route, FractureModel model) {
  Scene scene = pulled_board(Vec3(0, -130, 0));
  scene.fracture.model = model;
  scene.fracture.max_events = 3;
  scene.solver.route = route;
  scene.steps = 30;
  return scene;
}

Scene by_law(MaterialLaw law) {
  Scene scene = board(Route::automatic, FractureModel::a);
  for (auto& [name, material] : scene.materials) material.law = law;
  return scene;
}

Scene moving() {
  Scene scene = by_law(MaterialLaw::corotated);
  for (auto& [name, material] : scene.materials) material.density = 1e-9;
  scene.dynamics = Dynamics{.time_step = 0.002};
  return scene;
}

Scene splitting() {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  return scene;
}

void print(const char* name, const Scene& scene) {
  auto problem = std::make_shared<const Problem>(scene);
  Simulation simulation(problem, create_backend(problem, needs_of(*problem)).backend);
  while (!simulation.done() && simulation.destroyed().size() < kMost) {
    static_cast<void>(simulation.step());
  }
  std::printf("board %s\n", name);
  for (const DestroyedElement& e : simulation.destroyed()) {
    std::printf("rupture %d %d\n", e.step, static_cast<int>(e.element));
  }
  for (const Vec3& u : simulation.displacement()) std::printf("u %a %a %a\n", u[0], u[1], u[2]);
}

}  // namespace
}  // namespace sunder::test

int main() {
  using namespace sunder::test;
  using sunder::FractureModel, sunder::MaterialLaw, sunder::Route;
  print("inverse", board(Route::inverse, FractureModel::a));
  print("inverse-b", board(Route::inverse, FractureModel::b));
  print("factor", board(Route::factor, FractureModel::b));
  print("condensed", board(Route::condensed, FractureModel::b));
  print("cg", board(Route::cg, FractureModel::a));
  print("corotated", by_law(MaterialLaw::corotated));
  print("neo-hookean", by_law(MaterialLaw::neo_hookean));
  print("motion", moving());
  print("split", splitting());
}
