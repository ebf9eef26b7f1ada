// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/energy_release.hpp"

#include <algorithm>

#include "body/law_stress.hpp"

namespace sunder::fracture {

double energy_release(const IntegralInput& in) {
  const Mat3 axes = in.frame.axes(in.board.plane());
  double sum = 0;
  for (std::size_t i = 0; i < in.domain.elements.size(); ++i) {
    const Index e = in.domain.elements[i];
    const auto& corners = in.domain.corners[i];
    const auto& shape = in.problem.shape(e);
    Mat3 gradient = Mat3::Zero();
    Vec3 weight_gradient = Vec3::Zero();
    for (int a = 1; a < 4; ++a) {
      const auto at = static_cast<std::size_t>(a);
      gradient += (in.displacement[corners[at]] - in.displacement[corners[0]]) *
                  shape.gradient.col(a).transpose();
      weight_gradient +=
          (in.domain.weight[corners[at]] - in.domain.weight[corners[0]]) * shape.gradient.col(a);
    }
    const Law& law = fem::law_of(in.problem, e);
    const Mat3 f = Mat3::Identity() + gradient;
    const bool pools = !in.patches.empty() && in.patches[i];
    const auto [energy, stress] =
        pools ? fem::pooled_stress(in.problem, e, f, *in.patches[i])
              : fem::PooledStress{law.energy(in.problem.small_strain(e), f),
                                  law.stress(in.problem.small_strain(e), f)};
    const Vec3 x1 = axes.row(0);
    sum += shape.volume *
           ((stress * weight_gradient).dot(gradient * x1) - energy * weight_gradient.dot(x1));
    const auto& tet = in.board.mesh().tets[e];
    for (const FreeSurface::Face& face : in.surface.of(e)) {
      if (!face.lateral || (face.notch != kNone && face.notch == in.crack)) continue;
      double weight = 0;
      for (Index n : face.nodes) {
        const auto corner = std::find(tet.begin(), tet.end(), n) - tet.begin();
        weight += in.domain.weight[corners[static_cast<std::size_t>(corner)]] / 3;
      }
      sum += weight * energy * face.area.dot(x1);
    }
  }
  return sum / in.domain.front_length;
}

}  // namespace sunder::fracture
