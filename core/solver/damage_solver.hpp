// SPDX-License-Identifier: Apache-2.0
// The solution by a deferred update's small matrices, by whoever can multiply them faster than the
// host once they are large: a device, which has them beside the host and follows as they change.
// With the grips held, A^-1 = X + X B S B^T X and u = X B T d for displacements d of the gripped
// unknowns: S = M - T C T^T and T = (E + M G_G) C^-1, C = (A^-1)_GG, E the gripped unknowns' unit
// vectors (deferred.hpp has the rest).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "linear_algebra/row_product.hpp"
#include "sunder/types.hpp"

namespace sunder::solver {

/// The small matrices as the host has them, leading n x n blocks; grips: g.
struct SmallMatrices {
  Index columns = 0;                                                                 // n
  const linear_algebra::RowMajor *compliance = nullptr, *m = nullptr, *d = nullptr;  // G, M, D
  std::span<const Index> held;        // columns of B that are the gripped unknowns', in their order
  std::span<const Index> only_grips;  // columns of B on which only grips act
  /// T^T and L^-1 (E + M G_G)^T, L L^T = C, leading g x n blocks: S = M - their products' second.
  const linear_algebra::RowMajor *t = nullptr, *of_grips = nullptr;
};

class DamageSolver {
 public:
  DamageSolver() = default;
  DamageSolver(const DamageSolver&) = delete;
  DamageSolver& operator=(const DamageSolver&) = delete;
  virtual ~DamageSolver() = default;

  /// Whether so many columns and grips are worth it and have room.
  [[nodiscard]] virtual bool takes(Index columns, Index grips) const = 0;
  /// Nothing is known of the matrices any more.
  virtual void forget() = 0;
  /// Nothing of S and T: other grips hold the body.
  virtual void forget_forces() = 0;
  /// D has changed in these rows and columns.
  virtual void change_stiffness(std::span<const Index> rows) = 0;
  /// Whether update() with so many vectors and columns is of use: S and T are there, and it has
  /// room. Without room it forgets these.
  [[nodiscard]] virtual bool follows(Index rank, Index columns) = 0;
  /// [T S] += W^T [V W], or -=, where B has so many columns now: W (rank x columns), V (rank x g).
  virtual void update(const linear_algebra::RowMajor& w, const linear_algebra::RowMajor& v,
                      Index rank, Index columns, bool subtract) = 0;
  /// Whether bring() asks for SmallMatrices::t and of_grips.
  [[nodiscard]] virtual bool wants_grips() const = 0;
  /// Takes what is new, as much as a solution has the time for. False: solve() lacks some of it.
  virtual bool bring(const SmallMatrices& all) = 0;
  /// x from B^T X f = p and the displacements of the grips (empty: 0), refined as often as there is
  /// room for energies: of each the energy that was lacking before it, with the grips held.
  virtual void solve(const Eigen::VectorXd& p, std::span<const double> displacement,
                     std::span<double> energies, Eigen::VectorXd& x) = 0;
  /// The last x refined again.
  virtual void refine(std::span<double> energies, Eigen::VectorXd& x) = 0;

  /// What a Deferred works out for it, in room that outlives any base.
  struct Work {
    linear_algebra::RowMajor w, v, y, z, t, of_grips;
    Eigen::MatrixXd c;
    std::vector<Index> held, only_grips;
  };
  Work work;
};

}  // namespace sunder::solver
