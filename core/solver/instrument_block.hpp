// SPDX-License-Identifier: Apache-2.0
// The frame's side of InstrumentForces: from what any backend knows of a solution, its reactions
// and the compliance of the gripped unknowns, to what is published.
#pragma once

#include <memory>
#include <vector>

#include "sunder/instrument_forces.hpp"
#include "sunder/problem.hpp"

namespace sunder::solver {

/// Stiffness [N/mm] of the anchor of each gripped unknown.
[[nodiscard]] std::vector<double> anchors_of(const Problem& problem);

class InstrumentBlock {
 public:
  explicit InstrumentBlock(const Problem& problem);

  [[nodiscard]] const std::shared_ptr<InstrumentForces>& forces() const { return forces_; }
  /// Publishes to these from now on, which belonged to another backend of the same problem.
  void take_over(std::shared_ptr<InstrumentForces> forces) { forces_ = std::move(forces); }

  /// Of so many gripped unknowns, the problem's and then those of a host, which have none: 0.
  [[nodiscard]] std::span<const double> anchors(std::size_t grips);
  /// `l`: L L^T = (A^-1)_GG, a lower triangle, of the problem's grips and then those of a host. The
  /// reactions are those of a solution with the grips at `displacements`. Allocates nothing unless
  /// there are more grips than ever.
  void publish(const Eigen::Ref<const Eigen::MatrixXd>& l, std::span<const double> reactions,
               std::span<const double> displacements);

 private:
  std::shared_ptr<InstrumentForces> forces_;
  std::vector<double> anchors_;
  Eigen::VectorXd f_, half_, u_0_;
};

}  // namespace sunder::solver
