// SPDX-License-Identifier: Apache-2.0
// The stability studies' own yardstick: volume pooled over patches (docs/method.md "Pooled volume")
// or by element, in extended precision from the first iteration to the stress. Of what it judges it
// takes the checked problem and the list of intact patches; elements, laws and fibres are those of
// cpu_reference/plain.
#pragma once

#include "body/pools.hpp"
#include "cpu_reference/plain/finite.hpp"

namespace sunder::bench {

/// Patches are of laws "linear" and "neo-hookean"; elements that do not pool are by any law.
class Yardstick {
 public:
  using Real = plain::Real;

  /// A destroyed element keeps its share alpha where the body is one of small strain; in one of
  /// finite deformation it adds nothing.
  Yardstick(const Problem& problem, std::span<const std::uint8_t> destroyed);

  struct Rest {
    std::vector<double> u;      ///< (3 * nodes)
    std::vector<Voigt> stress;  ///< Cauchy's; where destroyed 0, or what its share bears
    double correction = 0;      ///< last step over the displacement, by 2-norms
  };
  /// Newton's method from `start` (3 * nodes; empty: 0) until its steps are at rounding. Throws
  /// std::runtime_error where a tangent is not definite or steps do not vanish.
  [[nodiscard]] Rest solve(const Load& load, std::span<const double> start = {}) const;

 private:
  using Real3x3 = plain::Real3x3;
  struct Patch {
    Real bulk = 0, shear = 0;
    bool linear = true;
    std::vector<std::size_t> elements;
  };
  struct Pressure {
    Real volume = 0, pressure = 0, stiffness = 0;  // V_p, U'(J_p), U''(J_p)
  };
  void split_patches(const std::vector<Index>& body_of_element);
  [[nodiscard]] Real3x3 deformed(std::size_t element, const std::vector<Real>& u) const;
  [[nodiscard]] Real3x3 cofactor(std::size_t element, const Real3x3& f) const;
  [[nodiscard]] std::vector<Pressure> pressures(const std::vector<Real>& u) const;
  [[nodiscard]] Real3x3 stress(std::size_t element, const Real3x3& f,
                               const std::vector<Pressure>& of) const;
  [[nodiscard]] Real3x3 change(std::size_t element, const Real3x3& f, const Real3x3& df,
                               const std::vector<Pressure>& of) const;
  [[nodiscard]] std::vector<Real> forces(const std::vector<Real>& u) const;
  [[nodiscard]] Eigen::VectorXd step(const std::vector<Real>& u, const Eigen::VectorXd& r) const;

  const Problem& problem_;
  std::vector<plain::Element> elements_;
  std::vector<plain::Fibres> fibres_;
  std::vector<const plain::Law*> laws_;
  std::vector<std::size_t> patch_of_;  // largest number: pools nothing
  std::vector<Patch> patches_;
  std::vector<std::size_t> places_;  // per dof: 3 * node + axis
  std::vector<std::uint8_t> free_;   // per dof
};

/// Whether a material of the problem pools its volume.
[[nodiscard]] bool pools_volume(const Problem& problem);

}  // namespace sunder::bench
