// SPDX-License-Identifier: Apache-2.0
// Update `deferred`: damage carried by a small matrix over a base that stays pristine
// (Sherman-Morrison-Woodbury). With A = K0 - W W^T and S = I - W^T X W,
// A^-1 f = X (f + W S^-1 W^T X f); grips add forces h on the gripped unknowns G so that u_G = d.
#pragma once

#include <Eigen/Cholesky>
#include <memory>
#include <span>
#include <vector>

#include "engine/base.hpp"
#include "engine/bordered_cholesky.hpp"

namespace sunder::engine {

class Deferred {
 public:
  /// `gripped`: unknowns with prescribed displacement, ascending.
  Deferred(std::unique_ptr<Base> base, std::span<const Index> gripped);

  /// Follows an event. Returns false and changes nothing when the damaged stiffness is not
  /// positive definite in double precision.
  [[nodiscard]] bool destroy(const Problem& problem, std::span<const Index> elements);
  /// Takes the last event back: every later result is bit by bit what it was before the event.
  void take_back();
  /// Makes one event of all, so that unknowns that events share count once: 200 fractures of a
  /// crack have rank 1200 one by one and about 250 together. What was compacted cannot be taken
  /// back one by one. Returns false when the whole is not positive definite in double precision;
  /// the damage is then unusable.
  [[nodiscard]] bool compact(const Problem& problem);

  /// u = A^-1 f with u_G = displacement (empty: 0).
  void solve(const Forces& forces, std::span<const double> displacement, Eigen::VectorXd& u);

  [[nodiscard]] Index events() const { return static_cast<Index>(ranks_.size()); }
  /// Columns of W: what a frame pays for the damage.
  [[nodiscard]] Index rank() const { return static_cast<Index>(small_.size()); }
  [[nodiscard]] std::vector<BufferPlan> buffers() const;

 private:
  [[nodiscard]] bool factor_grips();

  std::unique_ptr<Base> base_;
  std::vector<Index> gripped_;
  std::vector<Index> ranks_;                  // rank before each event
  std::vector<std::vector<Index>> elements_;  // of each event
  BorderedCholesky small_;                    // S = L L^T
  Eigen::MatrixXd grip_x_;                    // X_GG
  Eigen::MatrixXd grip_rows_;                 // L^-1 W^T X_G, shape (rank x grips)
  Eigen::LLT<Eigen::MatrixXd> grip_block_{
      Eigen::MatrixXd(0, 0)};  // (A^-1)_GG = X_GG + grip_rows^T grip_rows
  Eigen::VectorXd coefficients_, forces_;
};

}  // namespace sunder::engine
