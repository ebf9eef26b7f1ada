// SPDX-License-Identifier: Apache-2.0
// The damage as a correction to a base inverse X that is never overwritten, in fp64 on the host:
// u = X f + X_E c, where E are the dofs touched by destroyed elements, held by grips or loaded (if
// few), X_E exact columns of X, and c = M X_E^T f. An event on E adds a low-rank term to the small
// matrix M alone.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "gpu/passes/dense_inverse.hpp"
#include "sunder/problem.hpp"

namespace sunder::gpu {

/// A load on up to so many dofs is multiplied by exact columns: fp32 columns alone would cost 1e-4
/// of the board's largest stress, in its stiff frame.
inline constexpr std::size_t kExactLoads = 64;

/// An event's update vectors with at most as many columns as dofs: W W^T is unchanged.
[[nodiscard]] Eigen::MatrixXd compressed(const Eigen::MatrixXd& w);

class Correction {
 public:
  /// Exact columns of the base, shape (n x dofs).
  using Columns = std::function<Eigen::MatrixXd(std::span<const Index> dofs)>;

  /// E begins with the gripped dofs.
  Correction(const Problem& problem, Columns columns);

  /// Follows an event: M += V C^-1 V^T with V = W + M X_ET W, C = I - W^T X' W. Returns false and
  /// changes nothing but E when C is not positive definite in double precision.
  /// Cost 12 k |E|^2 flops and the new columns.
  [[nodiscard]] bool destroy(std::span<const Index> elements);

  /// Adds dofs to E: what they carry is then multiplied by exact columns as well.
  void extend(std::span<const Index> dofs);
  /// How many of some dofs, or of those that elements touch, are not in E yet.
  [[nodiscard]] Index new_dofs(std::span<const Index> dofs) const;
  [[nodiscard]] Index new_dofs_of(std::span<const Index> elements) const;

  /// X_E, shape (n x at least count()).
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }
  [[nodiscard]] Index count() const { return static_cast<Index>(dofs_.size()); }
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }

  /// Moves what a load carries on dofs of E to coefficients of the exact columns.
  [[nodiscard]] Eigen::VectorXd take_exact(Loaded& load) const;
  /// X_E^T f.
  [[nodiscard]] Eigen::VectorXd project(const Loaded& load) const;
  /// X_E^T r, r over all unknowns.
  [[nodiscard]] Eigen::VectorXd project(const Eigen::VectorXd& r) const {
    return columns_.leftCols(count()).transpose() * r;
  }
  /// c for the force f given as X_E^T f, with the gripped dofs at `displacement` (empty: 0). Throws
  /// NumericalError when the grips' compliance is singular.
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& projection,
                                             std::span<const double> displacement) const;

  /// L with L L^T = (X')_GG of the gripped dofs, a lower triangle.
  [[nodiscard]] const Eigen::MatrixXd& grip_factor() const { return grips_.matrixLLT(); }

  /// What the damage adds to r^T X r, for X_E^T r: r^T A^-1 r = r^T X r + energy.
  [[nodiscard]] double energy(const Eigen::VectorXd& projection) const;
  /// r_E^T X_EE r_E of a residual's values on E.
  [[nodiscard]] double base_energy(const Eigen::VectorXd& values) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  void factor_grips();

  const Problem& problem_;
  Columns base_;
  std::vector<Index> dofs_;      // of E
  std::vector<Index> place_;     // of every unknown in E, kNone outside
  Eigen::MatrixXd columns_, x_;  // X_E, X_EE (by rows and columns in the order of E)
  Eigen::MatrixXd m_;
  Eigen::LLT<Eigen::MatrixXd> grips_;  // (X')_GG
};

}  // namespace sunder::gpu
