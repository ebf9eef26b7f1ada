// SPDX-License-Identifier: Apache-2.0
// The yardstick of every route and device: assembly, LDL^T and loops, anew for whatever is
// destroyed. It takes the mesh and the checked problem (what is held and gripped) from what it
// judges, and nothing else. The factor is in double precision; residuals in extended precision
// refine its solution beyond what double precision promises.
#pragma once

#include <Eigen/SparseCholesky>

#include "cpu_reference/plain/element.hpp"
#include "sunder/backend.hpp"

namespace sunder::plain {

struct Solution {
  std::vector<double> displacement;  ///< (3 * nodes) [mm]
  std::vector<Voigt> stress;         ///< (elements) D B u, times alpha where destroyed [MPa]
  std::vector<double> reactions;     ///< (gripped dofs) K u - f: what the grips exert [N]
  double residual = 0;               ///< |f - K u| of free dofs over |f|, with what grips exert
  double error = 0;                  ///< largest stress of the last correction over the solution's
};

class Body {
 public:
  /// `destroyed`: 1 for destroyed elements; empty: none.
  explicit Body(const Problem& problem, std::span<const std::uint8_t> destroyed = {});
  void destroy(std::span<const Index> elements);
  /// Throws std::runtime_error where the stiffness is not definite: a test may take a
  /// NumericalError for a refusal by what it judges.
  [[nodiscard]] Solution solve(const Load& load);
  template <class Displacement>
  [[nodiscard]] std::vector<Voigt> stress(const Displacement& u) const {
    std::vector<Voigt> all;
    for (const Element& e : elements_)
      all.push_back(e.stress(e.corners(u)).template cast<double>());
    return all;
  }
  /// Over live elements that are not left out.
  [[nodiscard]] Deformation deformation(std::span<const double> u,
                                        std::span<const std::uint8_t> left_out) const;

 protected:
  void factorise();
  [[nodiscard]] std::vector<Real> forces(const std::vector<Real>& u) const;  // K u
  void refine(const std::vector<Real>& f, std::vector<Real>& u, Solution& s) const;

  const Problem& problem_;
  std::vector<Element> elements_;
  std::vector<std::size_t> places_;  // per dof: 3 * node + axis
  std::vector<std::uint8_t> free_;   // per dof: 0 where gripped
  bool factorised_ = false;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

/// Whole scenes on it, event by event. No scene names it: tests and studies create it.
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs);

}  // namespace sunder::plain
