// SPDX-License-Identifier: Apache-2.0
#include "body/layer_geometry.hpp"

namespace sunder::fem {

std::vector<std::uint8_t> nodes_of_volume(const Mesh& mesh, const std::string& name) {
  std::vector<std::uint8_t> has(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (mesh.volumes[static_cast<std::size_t>(mesh.volume_of[e])].name != name) continue;
    for (Index n : mesh.tets[e]) has[static_cast<std::size_t>(n)] = 1;
  }
  return has;
}

Vec3 slope_across(const TetShape& shape, const std::array<Index, 4>& tet,
                  const std::vector<std::uint8_t>& first) {
  Vec3 slope = Vec3::Zero();
  for (int a = 0; a < 4; ++a) {
    if (first[static_cast<std::size_t>(tet[static_cast<std::size_t>(a)])] == 0) {
      slope += shape.gradient.col(a);
    }
  }
  return slope;
}

}  // namespace sunder::fem
