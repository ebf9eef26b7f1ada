// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/turned_back.hpp"

#include <algorithm>
#include <cmath>

#include "body/deformation.hpp"
#include "material/singular_values.hpp"

namespace sunder::fracture {
namespace {

/// F of the domain's element i.
Mat3 gradient(const Problem& problem, const TipDomain& domain, std::size_t i,
              std::span<const Vec3> displacement) {
  const auto& corners = domain.corners[i];
  const auto& shape = problem.shape(domain.elements[i]).gradient;
  Mat3 f = Mat3::Identity();
  for (int a = 1; a < 4; ++a) {
    const auto at = static_cast<std::size_t>(a);
    f += (displacement[corners[at]] - displacement[corners[0]]) * shape.col(a).transpose();
  }
  return f;
}

}  // namespace

TurnedBack turn_back(const Problem& problem, const TipDomain& domain,
                     std::span<Vec3> displacement) {
  TurnedBack back;
  Mat3 mean = Mat3::Zero();
  for (std::size_t i = 0; i < domain.elements.size(); ++i) {
    mean += problem.shape(domain.elements[i]).volume * gradient(problem, domain, i, displacement);
  }
  back.rotation = polar(mean).rotation;
  for (std::size_t n = 0; n < domain.nodes.size(); ++n) {
    const Vec3& x = problem.mesh().nodes[domain.in_mesh[n]];
    displacement[n] = back.rotation.transpose() * (x + displacement[n]) - x;
  }
  for (std::size_t i = 0; i < domain.elements.size(); ++i) {
    const Mat3 f = gradient(problem, domain, i, displacement);
    const double stretch = (singular_values(f).s.array() - 1).abs().maxCoeff();
    back.strain = std::max(back.strain, stretch);
    back.rotation_deg = std::max(back.rotation_deg, fem::rotation_deg(f - Mat3::Identity()));
  }
  return back;
}

}  // namespace sunder::fracture
