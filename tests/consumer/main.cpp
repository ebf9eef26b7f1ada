// SPDX-License-Identifier: Apache-2.0
// A user of the installed package: a bar of two elements from arrays, pulled until one breaks.
#include <cmath>
#include <cstdio>
#include <memory>
#include <sunder/backends.hpp>
#include <sunder/simulation.hpp>

int main() {
  sunder::Scene scene;
  scene.source = "consumer";
  scene.mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  scene.mesh.tets = {{0, 1, 2, 3}, {1, 4, 2, 3}};
  scene.mesh.volumes = {{"tissue", 1}};
  scene.mesh.volume_of = {0, 0};
  scene.materials["tissue"] = {5.0, 0.4, 2.0};
  scene.supports.push_back({std::vector<sunder::Index>{0, 2, 3}, {}});
  scene.instruments.push_back(
      {"forceps", sunder::Pull{std::vector<sunder::Index>{4}, {40, 0, 0}}, {}});
  scene.fracture.model = sunder::FractureModel::a;

  auto problem = std::make_shared<const sunder::Problem>(std::move(scene));
  auto created = sunder::create_backend(problem, sunder::needs_of(*problem));
  sunder::Simulation simulation(problem, std::move(created.backend));
  const sunder::StepReport report = simulation.step();
  std::printf("destroyed %d elements, compliance %g N mm, stress error %g\n", report.destroyed,
              report.compliance, report.error);
  return report.destroyed > 0 && std::isfinite(report.compliance) ? 0 : 1;
}
