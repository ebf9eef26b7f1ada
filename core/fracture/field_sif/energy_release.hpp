// SPDX-License-Identifier: Apache-2.0
// J [N/mm] of a tip at any deformation: the domain integral of the energy-momentum tensor W I - H^T
// P (Eshelby 1951; Shih, Moran and Nakamura 1986), in the undeformed body, where the crack lies:
//
//   J = 1/t int_V (P_iJ H_i1 - W delta_1J) q,J dV + 1/t int over the body's free surface  q W N_1
//   dA
//
// with H = grad u of the domain turned back by its own rotation, P and W by the laws of its
// elements. The faces of the crack itself carry no term, and forces within the domain are left
// out.
#pragma once

#include "fracture/field_sif/interaction_integral.hpp"

namespace sunder::fracture {

/// Of the domain's displacement as it is there. No number where a law knows no such state.
[[nodiscard]] double energy_release(const IntegralInput& input);

}  // namespace sunder::fracture
