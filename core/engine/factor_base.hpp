// SPDX-License-Identifier: Apache-2.0
// Base `factor`: X = P^T L^-T L^-1 P by sparse Cholesky. A block of vectors is kept as L^-1 P V on
// its paths in the elimination tree, which is all that it can reach.
#pragma once

#include "engine/base.hpp"
#include "fem/factor.hpp"

namespace sunder::engine {

class FactorBase final : public Base {
 public:
  /// The factor must outlive the base.
  explicit FactorBase(const fem::Factor& factor);

  [[nodiscard]] Index size() const override { return l_.size(); }
  Eigen::MatrixXd push(const fem::EventFactor& block) override;
  void pop() override;
  const Eigen::VectorXd& load(const Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

 private:
  /// Rows of L that follow each other: `place` counts the block's own rows.
  struct Run {
    Index row, length, place;
  };
  struct Block {
    std::vector<Run> runs;  // ascending
    fem::RowMajor v;        // L^-1 P V on those rows
  };

  [[nodiscard]] std::vector<Run> runs_of(std::span<const Index> supernodes) const;
  [[nodiscard]] Block reduce(const fem::EventFactor& block);

  const fem::SupernodalCholesky& l_;
  std::vector<Block> blocks_;
  Eigen::Index columns_ = 0;
  std::vector<Index> places_;    // of a block's unknowns in L
  fem::RowMajor work_;           // rows of L, all zero between calls
  Eigen::VectorXd of_load_, y_;  // L^-1 P f; the sum to solve back
  Eigen::VectorXd projected_, gathered_;
};

}  // namespace sunder::engine
