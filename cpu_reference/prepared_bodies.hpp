// SPDX-License-Identifier: Apache-2.0
// What backends of one intact body have in common and none of them writes to.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

#include "body/analysis.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::cpu_reference {

/// Each part is made by whoever asks for it first; others wait for it.
class PreparedBody {
 public:
  explicit PreparedBody(std::shared_ptr<const Problem> problem) : problem_(std::move(problem)) {}
  [[nodiscard]] const Problem& problem() const { return *problem_; }

  [[nodiscard]] std::shared_ptr<const fem::Analysis> analysis();
  /// Throws NumericalError when it is not positive definite in double precision.
  [[nodiscard]] std::shared_ptr<const linear_algebra::Factor> factor();
  /// Shape (n x n), likewise.
  [[nodiscard]] std::shared_ptr<const Eigen::MatrixXd> inverse();

 private:
  std::shared_ptr<const Problem> problem_;
  std::mutex mutex_;
  std::shared_ptr<const fem::Analysis> analysis_;
  std::shared_ptr<const linear_algebra::Factor> factor_;
  std::shared_ptr<const Eigen::MatrixXd> inverse_;
};

class PreparedBodies {
 public:
  /// Of the bodies asked for last it keeps so many, at least one; those in use live on.
  explicit PreparedBodies(std::size_t most) : most_(most < 1 ? 1 : most) {}

  /// That of a problem with the same stiffness, or a new one. By any number of threads.
  [[nodiscard]] std::shared_ptr<PreparedBody> of(const std::shared_ptr<const Problem>& problem);

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::list<std::shared_ptr<PreparedBody>> bodies_;  // the one asked for last comes first
};

}  // namespace sunder::cpu_reference
