// SPDX-License-Identifier: Apache-2.0
// Pooled volume by laws of finite deformation (method.md "Pooled volume"): patches of elements that
// share the volume part U of their law's energy (VolumeSplit),
//   sum V_e W_s(F_e) + sum V_p U(J_p), V_p = sum V_e, J_p = sum V_e J_e / V_p over live elements,
// so that P_e = P_s(F_e) + U'(J_p) dJ/dF_e.
#pragma once

#include <span>
#include <vector>

#include "body/hyperelastic.hpp"
#include "body/pools.hpp"

namespace sunder::fem {

/// A body's patches at one displacement. Of a patch without live elements all is 0.
class PatchVolumes {
 public:
  PatchVolumes() = default;
  /// Empty where nothing pools. `pressure`: in place of U'(J_p) where it is not empty, one a patch.
  PatchVolumes(const HyperelasticBody& body, std::span<const double> u,
               std::span<const double> pressure = {});

  /// Patches have been split: each part has what its whole had, but for the energy, which is 0.
  void part(const Pools& was, const Pools& is);

  /// Sum of V_p U(J_p) [N mm]; infinite where a law knows no such volume.
  [[nodiscard]] double energy() const;
  /// U'(J_p) of each patch [MPa].
  [[nodiscard]] std::span<const double> pressure() const { return pressure_; }
  /// U''(J_p) of each [MPa].
  [[nodiscard]] std::span<const double> stiffness() const { return stiffness_; }

 private:
  std::vector<double> energy_, pressure_, stiffness_;
};

/// Whether an element's volume is its patch's, by a law that has a volume part.
[[nodiscard]] bool pools_volume(const HyperelasticBody& body, Index element);

/// U'(J_p) of one patch [MPa]; 0: it has no live element.
[[nodiscard]] double patch_pressure(const HyperelasticBody& body, Index patch,
                                    std::span<const double> u);

/// What a patch adds to the tangent: factor b b^T, b = sum V_e dJ/dF_e grad N over its live
/// elements at u, factor = U''/V_p.
struct PatchTangent {
  double factor = 0;
  Eigen::VectorXd b;  ///< per axis of Pools::nodes; empty: no live element
};
/// `stiffness`: U'' of the patch. By a kind that is not exact, none below 0.
[[nodiscard]] PatchTangent patch_tangent(const HyperelasticBody& body, Index patch,
                                         std::span<const double> u, double stiffness, Tangent kind);
/// Of all patches; empty: nothing pools.
[[nodiscard]] std::vector<PatchTangent> patch_tangents(const HyperelasticBody& body,
                                                       std::span<const double> u,
                                                       std::span<const double> stiffness,
                                                       Tangent kind);

}  // namespace sunder::fem
