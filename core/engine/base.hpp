// SPDX-License-Identifier: Apache-2.0
// The pristine inverse X = K0^-1, whatever holds it, and the update vectors laid over it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "fem/event_factor.hpp"
#include "sunder/backend.hpp"

namespace sunder::engine {

/// Forces on some unknowns, no unknown twice.
struct Forces {
  std::span<const Index> dofs;
  std::span<const double> values;
};

/// X is never overwritten. Blocks of vectors V = [V_1 V_2 ...] (update vectors of events, unit
/// vectors of grips) are pushed and popped like a stack.
class Base {
 public:
  virtual ~Base() = default;
  Base() = default;
  Base(const Base&) = delete;
  Base& operator=(const Base&) = delete;

  [[nodiscard]] virtual Index size() const = 0;
  /// Lays a block over the base; returns V^T X V_new, shape (columns with the new x new).
  virtual Eigen::MatrixXd push(const fem::EventFactor& block) = 0;
  /// Takes the last block away.
  virtual void pop() = 0;
  /// Takes a load and returns V^T X f.
  virtual const Eigen::VectorXd& load(const Forces& forces) = 0;
  /// u = X (f + V c) with the f of the last load().
  virtual void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) = 0;
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
};

}  // namespace sunder::engine
