// SPDX-License-Identifier: Apache-2.0
// Base `factor`: X = P^T L^-T L^-1 P by sparse Cholesky. A column is kept as L^-1 P e on its path
// in the elimination tree, which is all that it can reach.
#pragma once

#include "linear_algebra/factor.hpp"
#include "solver/last_load.hpp"
#include "solver/path_columns.hpp"
#include "solver/prepared_columns.hpp"

namespace sunder::solver {

class FactorBase final : public Base {
 public:
  /// The factor must outlive the base.
  explicit FactorBase(const linear_algebra::Factor& factor);

  [[nodiscard]] Index size() const override { return l_.size(); }
  void make_room() override;
  void push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) override;
  void pop() override;
  const Eigen::VectorXd& load(const Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  void prepare(std::span<const Difference> vectors) override;
  [[nodiscard]] double saved_ms() const override { return prepared_.saved_ms(); }
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

 private:
  /// Puts some of the vectors into the first columns of rows_, and solves forward.
  void forward_group(std::span<const Difference> vectors, std::span<const Index> which);
  void find_path(std::span<const Difference> vectors);
  void spread_missing();
  void clear_rows();
  void push_group(std::span<const Difference> vectors, Index column,
                  linear_algebra::RowMajor& gram);
  void forward(const Forces& forces, Eigen::VectorXd& y);

  const linear_algebra::SupernodalCholesky& l_;
  PathColumns columns_;
  PreparedColumns prepared_;
  std::vector<Index> missing_;        // of the group: not prepared
  std::vector<Difference> asked_;     // to be prepared
  std::vector<Difference> wanted_;    // of them, each once: those that are not there
  std::vector<Index> groups_;         // of each push
  std::vector<Index> places_, path_;  // of the group in L
  linear_algebra::RowMajor rows_,
      block_;  // rows of L, all zero between calls; part of the compliance
  LastLoad load_;
  Eigen::VectorXd of_load_, y_;  // L^-1 P f; the sum to solve back
  Eigen::VectorXd projected_;    // B^T X f
  Index known_ = 0;              // its entries that hold for the load
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::solver
