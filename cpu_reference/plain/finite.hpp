// SPDX-License-Identifier: Apache-2.0
// The yardstick at finite deformation: laws by their definitions in extended precision, and
// Newton's method with a new factor each time. As plain.hpp it shares nothing with what it judges.
#pragma once

#include "cpu_reference/plain/fibres.hpp"
#include "cpu_reference/plain/plain.hpp"

namespace sunder::plain {

/// Energy W, first Piola-Kirchhoff stress P, and how P changes with F. `d` is the linear law's
/// matrix: lambda = d(0, 1), mu = d(3, 3).
struct Law {
  using D = Eigen::Matrix<Real, 6, 6>;
  Real (*energy)(const D& d, const Real3x3& f);
  Real3x3 (*stress)(const D& d, const Real3x3& f);
  Real3x3 (*change)(const D& d, const Real3x3& f, const Real3x3& df);
};
extern const Law kLinear, kCorotated, kNeoHookean, kSaintVenantKirchhoff;
/// R of F = R S with det R = 1.
[[nodiscard]] Real3x3 rotation(const Real3x3& f);

/// Destroyed elements add nothing.
class FiniteBody : public Body {
 public:
  FiniteBody(const Problem& problem, const Law& law, std::span<const std::uint8_t> destroyed = {})
      : Body(problem, destroyed), laws_(elements_.size(), &law) {}
  /// By the laws of its materials, with their fibres.
  explicit FiniteBody(const Problem& problem, std::span<const std::uint8_t> destroyed = {});
  /// From u = 0 or `start` (3 * nodes) to a residual of 1e-10: Newton, with a shift where the
  /// tangent is indefinite, halved until the energy falls. No stress. Throws std::runtime_error.
  [[nodiscard]] Solution solve(const Load& load, std::span<const double> start = {}) const;
  /// Of live elements, in Voigt order; P itself where the law is linear.
  [[nodiscard]] std::vector<Voigt> stress(std::span<const double> u, StressMeasure measure) const;
  /// Of an element of an interface: traction P N over the strength, sqrt(<t_n>^2 + (t_s/ratio)^2).
  [[nodiscard]] Real parting_ratio(Index element, std::span<const double> u) const;
  /// Strain U - I, of the linear law sym grad u; over live elements that are not left out.
  [[nodiscard]] Deformation deformation(std::span<const double> u,
                                        std::span<const std::uint8_t> left_out) const;

 private:
  Real energy(const std::vector<Real>& u, const Eigen::VectorXd& load, Eigen::VectorXd& r) const;
  Eigen::VectorXd step(const std::vector<Real>& u, const Eigen::VectorXd& r) const;
  Real energy(std::size_t element, const Real3x3& f) const;
  Real3x3 stress(std::size_t element, const Real3x3& f) const;
  Real3x3 change(std::size_t element, const Real3x3& f, const Real3x3& df) const;
  std::vector<const Law*> laws_;  // per element
  std::vector<Fibres> fibres_;    // per element; empty: none
};

}  // namespace sunder::plain
