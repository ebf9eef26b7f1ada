// SPDX-License-Identifier: Apache-2.0
#include "body/lumped_mass.hpp"

namespace sunder::fem {

std::vector<double> lumped_masses(const Problem& problem, std::span<const double> density) {
  const Mesh& mesh = problem.mesh();
  std::vector<double> of(mesh.nodes.size(), 0.0);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const double quarter = density[mesh.volume_of[e]] * problem.shape(e).volume / 4;
    for (Index n : mesh.tets[e]) of[n] += quarter;
  }
  return of;
}

std::vector<double> lumped_masses(const Problem& problem) {
  std::vector<double> density(problem.mesh().volumes.size(), 0.0);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    density[problem.mesh().volume_of[e]] = problem.material(e).density.value();
  }
  return lumped_masses(problem, density);
}

}  // namespace sunder::fem
