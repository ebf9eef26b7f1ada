// SPDX-License-Identifier: Apache-2.0
// Damage seen as forces between neighbouring unknowns. An element's forces balance on each axis, so
// differences e_a - e_b along a tree through its corners carry them. In these coordinates a rigid
// motion is exactly nothing: where a node hangs on destroyed elements alone the small matrix of the
// damage has entries 1/alpha larger, and with unknowns for coordinates they would multiply the
// motion's rounding.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "body/element.hpp"
#include "linear_algebra/row_product.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

/// The vector e_dof - e_other; other = kNone: e_dof, the other end is held.
struct Difference {
  Index dof, other;
};

class DifferenceBasis {
 public:
  using Corners = std::array<Index, 4>;

  /// The problem must outlive it.
  explicit DifferenceBasis(const Problem& problem);

  /// Connects the corners of an element.
  void add(Index element) { add(problem_.mesh().tets[element]); }
  /// Connects nodes of the mesh.
  void add(const Corners& corners);
  [[nodiscard]] std::span<const Difference> differences() const { return differences_; }
  /// Back to the first differences.
  void shrink(std::size_t count);

  /// An element's update vectors (method.md "Elasticity" 3) in these coordinates: which
  /// differences, ascending, and 8 columns of `u` for each, the last two zero.
  void coordinates(Index element, std::vector<Index>& rows, linear_algebra::RowMajor& u);
  /// The same of forces on connected nodes that balance on each axis.
  void coordinates(const Corners& corners, const fem::UpdateFactor& forces,
                   std::vector<Index>& rows, linear_algebra::RowMajor& u);

 private:
  [[nodiscard]] std::array<Index, 4> vertices(const Corners& corners, int axis) const;
  [[nodiscard]] Index root(Index vertex) const;
  void connect(Index a, Index b, Index difference);

  const Problem& problem_;
  Index ground_;                      // the vertex of all held unknowns
  std::vector<Index> parent_, edge_;  // of each vertex: the next one, and the difference between
  std::vector<std::uint8_t> below_;   // corners of the element in work below each vertex
  std::vector<Index> marked_;         // vertices with a corner below
  std::vector<std::pair<Index, Index>> order_;  // difference, vertex under it
  std::vector<Difference> differences_;
};

}  // namespace sunder::solver
