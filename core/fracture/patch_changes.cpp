// SPDX-License-Identifier: Apache-2.0
#include "fracture/patch_changes.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "body/pools.hpp"

namespace sunder::fracture {

void PatchChanges::read(std::span<const Index> elements, const Body& body, const Mat3& turned) {
  of_elements_.clear();
  if (!problem_.pools()) return;
  of_elements_.resize(elements.size());
  const fem::Pools& pools = body.pools ? *body.pools : *problem_.pools();
  pools.of(elements, patches_);
  for (Index patch : patches_) {
    const fem::PatchChange change = of(pools.elements(patch), body, turned);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (pools.of(elements[i]) == patch) of_elements_[i] = change;
    }
  }
}

fem::PatchChange PatchChanges::of(std::span<const Index> patch, const Body& body,
                                  const Mat3& turned) {
  corners_.clear();
  for (Index e : patch) {
    const auto at = static_cast<std::size_t>(e);
    const auto& now = body.corners.empty() ? problem_.mesh().tets[at] : body.corners[at];
    corners_.insert(corners_.end(), now.begin(), now.end());
  }
  moved_.resize(corners_.size());
  body.displacement(corners_, moved_);
  // By laws of finite deformation what is destroyed adds nothing.
  const bool nothing = problem_.finite() || problem_.moves() || problem_.fibrous();
  const double alpha = nothing ? 0 : problem_.scene().fracture.alpha;
  const auto ratio = fem::law_of(problem_, patch.front()).split->ratio;
  double volume = 0, theta = 0, j = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const TetShape& shape = problem_.shape(patch[i]);
    Mat3 f = Mat3::Identity();
    for (std::size_t a = 1; a < 4; ++a) {
      f += (moved_[4 * i + a] - moved_[4 * i]) *
           shape.gradient.col(static_cast<Eigen::Index>(a)).transpose();
    }
    const bool gone = !body.destroyed.empty() && body.destroyed[static_cast<std::size_t>(patch[i])];
    const double share = (gone ? alpha : 1) * shape.volume;
    volume += share;
    theta += share * ((turned.transpose() * f).trace() - 3);
    j += share * ratio(f);
  }
  return {theta / volume, j / volume};
}

Voigt stress_with(const PatchChanges& patches, const Problem& problem, std::size_t i, Index e,
                  const Eigen::Matrix<double, 3, 4>& displacement) {
  const auto of = patches.of_elements();
  return of.empty() || !of[i] ? fem::material_stress(problem, e, displacement)
                              : fem::material_stress(problem, e, displacement, *of[i]);
}

}  // namespace sunder::fracture
