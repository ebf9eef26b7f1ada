// SPDX-License-Identifier: Apache-2.0
// Base `inverse`: X dense. Only the columns that carry load or damage are read.
#pragma once

#include "engine/base.hpp"
#include "engine/touched_dofs.hpp"
#include "fem/factor.hpp"

namespace sunder::engine {

class InverseBase final : public Base {
 public:
  /// Computes X from the factor, which must outlive the base: loads on so many unknowns that their
  /// columns cost more than two triangular solves go through it.
  explicit InverseBase(const fem::Factor& factor);

  [[nodiscard]] Index size() const override { return static_cast<Index>(x_.rows()); }
  Eigen::MatrixXd push(const fem::EventFactor& block) override;
  void pop() override;
  const Eigen::VectorXd& load(const Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

 private:
  struct Block {
    std::vector<Index> places;  // of its rows among the touched unknowns
    Eigen::MatrixXd w;
  };

  const fem::Factor& factor_;
  Eigen::MatrixXd x_;
  TouchedDofs touched_;
  std::vector<Block> blocks_;
  Eigen::Index columns_ = 0;
  std::vector<Index> load_dofs_;
  std::vector<double> load_values_;
  bool dense_load_ = false;
  Eigen::VectorXd of_load_;  // X f of a dense load
  Eigen::VectorXd projected_, at_touched_;
};

}  // namespace sunder::engine
