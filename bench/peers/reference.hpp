// SPDX-License-Identifier: Apache-2.0
// The yardstick of large torn bodies: a fresh supernodal factor by CHOLMOD with one refinement.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/tearing_board.hpp"

namespace sunder::bench {

struct Accuracy {
  double u = 0, stress = 0;
};

class Damaged {
 public:
  Damaged(const TearingBoard& board, std::span<const Index> destroyed);
  /// Errors over live elements that still hang on the support.
  [[nodiscard]] Accuracy accuracy(const Problem& problem, std::span<const double> u,
                                  std::span<const Voigt> stress) const;

 private:
  std::vector<std::uint8_t> ignored_;
  std::vector<double> u_;
  std::vector<Voigt> stress_;
};

/// Displacement at all nodes from that over the unknowns.
[[nodiscard]] std::vector<double> to_nodes(const Problem& problem, const Eigen::VectorXd& x);

/// Stress of every element, one after the other.
[[nodiscard]] std::vector<Voigt> plain_stress(const Problem& problem, std::span<const double> scale,
                                              std::span<const double> u);

}  // namespace sunder::bench
