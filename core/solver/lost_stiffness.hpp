// SPDX-License-Identifier: Apache-2.0
// The stiffness D that destroyed elements have lost, element by element: K u = (K0 - D) u.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "body/element.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

class LostStiffness {
 public:
  LostStiffness(const Problem& problem, std::span<const Index> elements);

  /// Unknowns of the elements, ascending.
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }
  /// y = D u, both in the order of dofs(). A motion of all corners together gives exactly nothing.
  void multiply(std::span<const double> u, std::span<double> y) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Element {
    std::array<Index, 12> dofs;  // places in dofs_, kNone: held
    fem::UpdateFactor u;         // D_e = u u^T
  };
  std::vector<Index> dofs_;
  std::vector<Element> elements_;
};

}  // namespace sunder::solver
