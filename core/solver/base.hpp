// SPDX-License-Identifier: Apache-2.0
// The pristine inverse X = K0^-1, whatever holds it, and the columns of it that damage and grips
// need.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "linear_algebra/row_product.hpp"
#include "solver/difference_basis.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

/// Forces on some unknowns, no unknown twice.
struct Forces {
  std::span<const Index> dofs;
  std::span<const double> values;
};

/// X is never overwritten. Vectors B = [B_1 B_2 ...] whose columns X B are at hand are pushed and
/// popped like a stack.
class Base {
 public:
  virtual ~Base() = default;
  Base() = default;
  Base(const Base&) = delete;
  Base& operator=(const Base&) = delete;

  [[nodiscard]] virtual Index size() const = 0;
  /// Makes room for vectors, so that a first push() allocates nothing.
  virtual void make_room() {}
  /// Adds vectors. B^T X B_new, B with the new ones, fills the leading block of `gram`, whose
  /// columns are as many as the new ones rounded up to a multiple of 8, or more.
  virtual void push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) = 0;
  /// Takes the last push away.
  virtual void pop() = 0;
  /// Takes a load and returns B^T X f, in as many leading entries as B has columns. The same load
  /// as last time costs nothing.
  virtual const Eigen::VectorXd& load(const Forces& forces) = 0;
  /// u = X (f + B c) with the f of the last load(); c is as long as B has columns, or longer.
  virtual void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) = 0;
  /// Computes what push() will need of these vectors, in place of others that were prepared before.
  /// push() gives the same bits with it and without.
  virtual void prepare(std::span<const Difference>) {}
  /// Milliseconds that push() has been spared so far.
  [[nodiscard]] virtual double saved_ms() const { return 0; }
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
};

}  // namespace sunder::solver
