// SPDX-License-Identifier: Apache-2.0
// The base below the deferred update of a device: the host has its columns X B in fp64, which the
// device gets as exact columns, and solves with its factor where all of X is needed. Columns come
// from the dense inverse that the host keeps, else from the device's in fp64, else from the factor.
// Where stiffnesses differ so much that columns of the latter two are off by more than displacement
// may be, each is refined once by the residual that elements sum.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "body/body_factors.hpp"
#include "body/damaged_body.hpp"
#include "gpu/host_inverse.hpp"
#include "solver/base.hpp"
#include "solver/last_load.hpp"

namespace sunder::gpu {

class HostBase final : public solver::Base {
 public:
  /// `body`: whose inverse it is, to refine columns by; null: they stay as they come. `device`: as
  /// read_from(). `columns`: that make_room() has room for.
  explicit HostBase(std::shared_ptr<const HostInverse> inverse,
                    const fem::DamagedBody* body = nullptr, const DenseInverse* device = nullptr,
                    Index columns = 256);

  /// The same inverse, in fp64 on the device, to read columns of from now on; it must outlive this.
  /// Null: there is none.
  void read_from(const DenseInverse* device) { device_ = device; }
  /// Columns of X, shape (n x dofs).
  [[nodiscard]] Eigen::MatrixXd unit_columns(std::span<const Index> dofs);
  /// Keeps some columns by the factor, for try_device().
  void keep_columns();
  /// read_from() where those columns say that it is the same but for rounding, refining what is
  /// read where much was rounded. False: it is not, and nothing changes.
  [[nodiscard]] bool try_device(const DenseInverse& device);
  [[nodiscard]] bool reads_device() const { return device_ != nullptr; }
  /// Whether columns need to be refined.
  [[nodiscard]] bool refines() const { return refines_; }

  [[nodiscard]] Index size() const override { return static_cast<Index>(columns_.rows()); }
  void make_room() override;
  void push(std::span<const solver::Difference> vectors, linear_algebra::RowMajor& gram) override;
  void pop() override;
  const Eigen::VectorXd& load(const solver::Forces& forces) override;
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;
  /// Counts what later bases are made by among buffers().
  void count_in(std::shared_ptr<const fem::BodyFactors> factors) { factors_ = std::move(factors); }

  [[nodiscard]] const HostInverse& inverse() const { return *inverse_; }
  /// X B, shape (n x at least count()).
  [[nodiscard]] const Eigen::MatrixXd& columns() const { return columns_; }
  [[nodiscard]] Index count() const { return static_cast<Index>(vectors_.size()); }

 private:
  void add_columns(std::span<const solver::Difference> vectors, Eigen::Index first);
  void read_units(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> to);
  double refine(std::span<const Index> dofs, Eigen::Ref<Eigen::MatrixXd> columns);
  void try_columns();
  [[nodiscard]] std::vector<Index> tried_unknowns() const;

  std::shared_ptr<const HostInverse> inverse_;
  std::shared_ptr<const fem::BodyFactors> factors_;  // empty: none
  const DenseInverse* device_ = nullptr;
  std::optional<fem::DamagedBody> body_;  // to refine by
  bool refines_ = false;
  Index room_;                               // columns
  Eigen::MatrixXd columns_, units_;          // units_: of those that an event needs
  std::vector<Index> dofs_;                  // which these are
  Eigen::MatrixXd kept_;                     // of unknowns that lie evenly; empty: none
  std::vector<solver::Difference> vectors_;  // B
  std::vector<std::size_t> pushes_;          // vectors_.size() before each
  solver::LastLoad load_;
  Eigen::VectorXd projected_, right_side_;
  Eigen::MatrixXd lacks_;           // of columns that are refined
  linear_algebra::RowMajor block_;  // the same in the factor's order
  Index projected_columns_ = 0;     // of projected_ that belong to the last load
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::gpu
