// SPDX-License-Identifier: Apache-2.0
// The frame's side of InstrumentForces: from what any backend knows of a solution, its reactions
// and the compliance of the gripped unknowns, to what is published.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sunder/instrument_forces.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

/// Stiffness [N/mm] of the anchors of gripped unknowns, 0 where one has none, as with those of a
/// host. Finds them anew, and allocates, only where others are gripped than at the last call.
class Anchors {
 public:
  /// Of the problem's own. The problem must outlive it.
  explicit Anchors(const Problem& problem) : problem_(problem) { (void)of(problem.gripped_dofs()); }
  /// One per unknown, until the next call.
  [[nodiscard]] std::span<const double> of(std::span<const Index> gripped);

 private:
  const Problem& problem_;
  std::vector<Index> gripped_;
  std::vector<double> stiffness_;
};

class InstrumentBlock {
 public:
  explicit InstrumentBlock(const Problem& problem);

  [[nodiscard]] const std::shared_ptr<InstrumentForces>& forces() const { return forces_; }
  /// Publishes to these from now on, which belonged to another backend of the same problem.
  void take_over(std::shared_ptr<InstrumentForces> forces) { forces_ = std::move(forces); }

  [[nodiscard]] std::span<const double> anchors(std::span<const Index> gripped) {
    return anchors_.of(gripped);
  }
  /// `l`: L L^T = (A^-1)_GG, a lower triangle, of the unknowns `gripped`: the problem's and then
  /// those of a host. The reactions are those of a solution with the grips at `displacements`.
  /// Allocates nothing unless others are gripped than before.
  void publish(std::span<const Index> gripped, const Eigen::Ref<const Eigen::MatrixXd>& l,
               std::span<const double> reactions, std::span<const double> displacements);

 private:
  std::shared_ptr<InstrumentForces> forces_;
  Anchors anchors_;
  Eigen::VectorXd f_, half_, u_0_;
};

}  // namespace sunder::solver
