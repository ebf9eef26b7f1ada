// SPDX-License-Identifier: Apache-2.0
// What grips feel of a body at finite deformation between frames: the Schur complement of the
// gripped unknowns of the present tangent. A few conjugate gradients on the base say how the rest
// follows a grip; what that costs is second order in their error (Rayleigh and Ritz).
#pragma once

#include <Eigen/Core>
#include <span>

#include "body/viscosity.hpp"
#include "solver/finite_base.hpp"

namespace sunder::solver {

struct GripTangent {
  fem::Inertia inertia = {};  ///< of a step of motion
  const fem::Viscosity* viscosity = nullptr;
  double viscous = 0;        ///< its factor
  bool felt_inertia = true;  ///< of the gripped nodes themselves
};

/// (gripped x gripped) [N/mm], symmetric: change of the grips' forces on the body per displacement
/// of the grips, at the state u, in the order of the body's gripped unknowns; a host's grips, which
/// the body has as its own, are among them. The base has followed the body; it is turned to u.
[[nodiscard]] Eigen::MatrixXd grip_stiffness(const RestingBody& now, std::span<const double> u,
                                             const fem::TangentPattern& pattern, FiniteBase& base,
                                             const GripTangent& of);

/// Lower L with L L^T = (stiffness + anchors)^-1. A direction in which the body does not resist, or
/// pushes the grip on, gets a stiffness next to none.
[[nodiscard]] Eigen::MatrixXd compliance_factor(const Eigen::MatrixXd& stiffness,
                                                std::span<const double> anchors);

}  // namespace sunder::solver
