// SPDX-License-Identifier: Apache-2.0
// K_I, K_II and K_III at a crack tip from the displacement field around it: the interaction
// integral in domain form (Yau, Wang, Corten 1980; Shih, Asaro 1988).
//
//   I = 1/t  int_V [s_ij u*_i,1 + s*_ij u_i,1 - s*_kl e_kl delta_1j] q,j dV
//     - 1/t  int over the body's free surface  q (s*_ij n_j u_i,1 - s*_kl e_kl n_1) dA
//     - 1/t  sum over loaded nodes  q f_i u*_i,1
//
// with the auxiliary state * of one unit stress intensity: K_I = E'/2 I_I, K_II = E'/2 I_II,
// K_III = mu I_III. t is the front's length, so K is its mean over the front. The faces of the
// crack itself carry no term: the auxiliary state leaves them free, and what the width of a crack
// of destroyed elements changes is of the order of (width / distance)^2. So it is with a notch of
// the body's shape: its walls and its root are faces of the crack. Where volume is pooled u_i,j, s
// and e are those of the element's deviator with its patch's change of volume.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fracture/criterion.hpp"
#include "fracture/field_sif/auxiliary_field.hpp"
#include "fracture/field_sif/free_surface.hpp"
#include "fracture/field_sif/tip_domain.hpp"
#include "fracture/patch_changes.hpp"
#include "sunder/problem.hpp"

namespace sunder::fracture {

/// Stress intensity factors [MPa sqrt(mm)], signs in the tip's frame: K_I > 0 opens, K_II > 0
/// moves the left face forward against the right one, K_III > 0 along x3.
struct IntensityFactors {
  double k_1 = 0, k_2 = 0, k_3 = 0;
};

struct IntegralInput {
  const Problem& problem;
  const Board& board;
  const FreeSurface& surface;
  const TipFrame& frame;
  const TipDomain& domain;
  std::span<const Vec3> displacement;  ///< of domain.nodes, mm
  std::span<const NodalForce> forces;  ///< those beyond the domain count nothing
  /// The crack behind the tip, the tip last; empty: it is straight there.
  std::span<const Vec2> bent_path;
  int crack = kNone;  ///< of the tip: the faces of its notch carry no term
  /// Of each element of the domain, where patches of pooled volume reach into it; else empty.
  std::span<const std::optional<fem::PatchChange>> patches = {};
};

struct TipIntegrals {
  IntensityFactors factors;
  /// J [N/mm] by the linear law, as energy_release() by any.
  double energy_release = 0;
};
[[nodiscard]] TipIntegrals interaction_integral(const IntegralInput& input,
                                                const TipMaterial& material);

/// K_I d, K_II d, K_III d [MPa sqrt(mm) mm] where the field is that of a crack which ends d behind
/// the tip: the same integral with the shift's states. 0 where it ends at the tip.
[[nodiscard]] IntensityFactors shift_integral(const IntegralInput& input,
                                              const TipMaterial& material);

}  // namespace sunder::fracture
