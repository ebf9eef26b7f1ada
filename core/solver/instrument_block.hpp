// SPDX-License-Identifier: Apache-2.0
// The frame's side of InstrumentForces: from what any backend knows of a solution, its reactions
// and the compliance of the gripped unknowns, to what is published.
#pragma once

#include <memory>
#include <vector>

#include "sunder/instrument_forces.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

/// Stiffness [N/mm] of the anchor of each gripped unknown, where a host grips others besides of
/// each of the scene's.
[[nodiscard]] std::vector<double> anchors_of(const Problem& problem);

class InstrumentBlock {
 public:
  explicit InstrumentBlock(const Problem& problem);

  [[nodiscard]] const std::shared_ptr<InstrumentForces>& forces() const { return forces_; }
  /// Publishes to these from now on, which belonged to another backend of the same problem.
  void take_over(std::shared_ptr<InstrumentForces> forces) { forces_ = std::move(forces); }

  /// `l`: L L^T = (A^-1)_GG, a lower triangle. The reactions are those of a solution with the grips
  /// at `displacements`. Allocates nothing (up to 10,000 gripped unknowns).
  void publish(const Eigen::Ref<const Eigen::MatrixXd>& l, std::span<const double> reactions,
               std::span<const double> displacements);

 private:
  std::shared_ptr<InstrumentForces> forces_;
  Eigen::VectorXd anchors_, f_, half_, u_0_;
};

}  // namespace sunder::solver
