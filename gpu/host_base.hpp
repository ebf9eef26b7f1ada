// SPDX-License-Identifier: Apache-2.0
// The base below the deferred update of a device: the host has its columns X B in fp64, which the
// device gets as exact columns, and solves with its factor where all of X is needed.
#pragma once

#include <memory>
#include <vector>

#include "gpu/host_inverse.hpp"
#include "solver/base.hpp"
#include "solver/last_load.hpp"

namespace sunder::gpu {

class HostBase final : public solver::Base {
 public:
  explicit HostBase(std::shared_ptr<const HostInverse> inverse);

  [[nodiscard]] Index size() const override { return static_cast<Index>(columns_.rows()); }
  void push(std::span<const solver::Difference> vectors, linear_algebra::RowMajor& gram) override;
  void pop() override;
  const Eigen::VectorXd& load(const solver::Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

  [[nodiscard]] const HostInverse& inverse() const { return *inverse_; }
  /// X B, shape (n x at least count()).
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }
  [[nodiscard]] Index count() const { return static_cast<Index>(vectors_.size()); }

 private:
  std::shared_ptr<const HostInverse> inverse_;
  Eigen::MatrixXd columns_;
  std::vector<solver::Difference> vectors_;  // B
  std::vector<std::size_t> pushes_;          // vectors_.size() before each
  solver::LastLoad load_;
  Eigen::VectorXd projected_, right_side_;
  Index projected_columns_ = 0;  // of projected_ that belong to the last load
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::gpu
