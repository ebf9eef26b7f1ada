// SPDX-License-Identifier: Apache-2.0
// Stress of a live element by the law of its material. By law "linear" that is fem::stress, bit by
// bit; at finite deformation there are several stresses, and each reader has its own.
#pragma once

#include "body/element.hpp"
#include "body/pools.hpp"
#include "material/law.hpp"

namespace sunder::fem {

/// The law of element e.
[[nodiscard]] const Law& law_of(const Problem& problem, Index e);

/// What criteria and results call stress: by the scene's `fracture.stress`. Columns of
/// `displacement`: the corners' [mm]. Not finite where the law knows no such state.
[[nodiscard]] Voigt named_stress(const Problem& problem, Index e,
                                 const Eigen::Matrix<double, 3, 4>& displacement);

/// In the material's frame (Biot's): what a crack, known in the undeformed body, is opened by.
[[nodiscard]] Voigt material_stress(const Problem& problem, Index e,
                                    const Eigen::Matrix<double, 3, 4>& displacement);

/// Of a patch of pooled volume, means over its elements by volume and share.
struct PatchChange {
  double theta = 0;  ///< tr grad u
  double j = 1;      ///< as its law measures it (VolumeSplit::ratio)
};
/// The same of an element that shares the volume of such a patch.
[[nodiscard]] Voigt material_stress(const Problem& problem, Index e,
                                    const Eigen::Matrix<double, 3, 4>& displacement,
                                    const PatchChange& patch);
/// Energy [MPa] and P of an element that shares a patch's volume, by a law of finite deformation.
struct PooledStress {
  double energy;
  Mat3 stress;
};
[[nodiscard]] PooledStress pooled_stress(const Problem& problem, Index e, const Mat3& f,
                                         const PatchChange& patch);

/// Forces on the corners [N] that the element resists its deformation with, from the displacement
/// at all nodes (3 * nodes). Of a destroyed one a share alpha, and none at finite deformation, in
/// motion and where there are fibres.
[[nodiscard]] Eigen::Matrix<double, 3, 4> corner_forces(const Problem& problem, Index e,
                                                        std::span<const double> u, bool destroyed);
/// The same of an element whose volume may be pooled, in statics by law "linear"; `field` is that
/// of u, `share` its a_e.
[[nodiscard]] Eigen::Matrix<double, 3, 4> corner_forces(const Problem& problem, Index e,
                                                        const StressField& field, double share);

}  // namespace sunder::fem
