// SPDX-License-Identifier: Apache-2.0
// Base `inverse`: X dense. Only the columns that carry load or damage are read.
#pragma once

#include <memory>

#include "linear_algebra/factor.hpp"
#include "solver/last_load.hpp"

namespace sunder::solver {

class InverseBase final : public Base {
 public:
  /// Computes X from the factor, which must outlive the base: where so many columns are needed
  /// that they cost more than two triangular solves, it takes their place.
  explicit InverseBase(const linear_algebra::Factor& factor)
      : InverseBase(factor, std::make_shared<const Eigen::MatrixXd>(inverse_of(factor))) {}
  /// X is there already, and others may read it too.
  InverseBase(const linear_algebra::Factor& factor, std::shared_ptr<const Eigen::MatrixXd> inverse);
  /// X, shape (n x n).
  [[nodiscard]] static Eigen::MatrixXd inverse_of(const linear_algebra::Factor& factor);

  [[nodiscard]] Index size() const override { return static_cast<Index>(x_->rows()); }
  void push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) override;
  void pop() override;
  const Eigen::VectorXd& load(const Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

 private:
  /// Whether so many columns cost more than solving with the factor.
  [[nodiscard]] bool too_many(std::size_t columns) const;
  /// u = X f; u may be any vector but right_side_.
  void apply(std::span<const Index> dofs, std::span<const double> values, Eigen::VectorXd& u);
  void project(const Eigen::VectorXd& u, Eigen::VectorXd& projected) const;

  const linear_algebra::Factor& factor_;
  std::shared_ptr<const Eigen::MatrixXd> x_;
  std::vector<Difference> vectors_;
  std::vector<std::size_t> pushes_;  // vectors_.size() before each
  std::vector<double> forces_;       // B c on the unknowns that B touches
  std::vector<Index> touched_;       // those unknowns, each once
  std::vector<Index> place_;         // of each unknown in touched_
  LastLoad load_;
  Eigen::VectorXd of_load_;  // X f
  Eigen::VectorXd projected_, right_side_;
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::solver
