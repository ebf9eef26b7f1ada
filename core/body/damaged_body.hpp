// SPDX-License-Identifier: Apache-2.0
// The damaged body: which elements are destroyed, K u element by element, and the stress of a
// displacement in plain loops. What checks a solution or makes a new base reads it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::fem {

class DamagedBody {
 public:
  explicit DamagedBody(std::shared_ptr<const Problem> problem);
  void destroy(std::span<const Index> elements);
  /// y = K x over the unknowns, without anchors.
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  /// Largest stress norm (Frobenius, MPa) over live elements of the displacement x.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x) const;
  /// Over live ones of some elements.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x,
                                      std::span<const Index> elements) const;
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const std::shared_ptr<const Problem>& shared_problem() const { return problem_; }
  /// a_e per element: 1 or alpha.
  [[nodiscard]] std::span<const double> scale() const { return scale_; }
  [[nodiscard]] std::span<const std::uint8_t> destroyed() const { return destroyed_; }

 private:
  void scatter(const Eigen::VectorXd& x) const;

  std::shared_ptr<const Problem> problem_;
  std::vector<double> scale_;
  std::vector<std::uint8_t> destroyed_;
  mutable std::vector<double> nodal_in_, nodal_out_;
};

}  // namespace sunder::fem
