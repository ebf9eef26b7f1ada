// SPDX-License-Identifier: Apache-2.0
// The stiffness D that elements have lost by leaving, or gained by coming, element by element:
// K u = (K0 - D) u.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "body/damaged_body.hpp"
#include "body/element.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

class LostStiffness {
 public:
  /// Of live elements of the mesh that leave.
  LostStiffness(const Problem& problem, std::span<const Index> elements);
  /// Of what has changed since the body had so many events.
  LostStiffness(const fem::DamagedBody& body, std::size_t events);

  /// Unknowns of the elements, ascending.
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }
  /// y = D u, both in the order of dofs(). A motion of all corners together gives exactly nothing.
  void multiply(std::span<const double> u, std::span<double> y) const;
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Element {
    std::array<Index, 12> dofs;  // places in dofs_, kNone: held
    fem::UpdateFactor u;         // D_e = u u^T, or -u u^T of what came
    bool came = false;
  };
  void add(const Problem& problem, const std::array<Index, 4>& corners, const fem::UpdateFactor& u,
           bool came);
  void number();
  std::vector<Index> dofs_;
  std::vector<Element> elements_;
};

}  // namespace sunder::solver
