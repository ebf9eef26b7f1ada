// SPDX-License-Identifier: Apache-2.0
// What a user would pick instead of Sunder to follow fractures: each with its best known settings,
// which the results page prints.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/tearing_board.hpp"

namespace sunder::bench {

/// Starts with the intact body factored (or inverted); every event follows on the one before.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Untimed: the event in the form that the peer takes (matrix, update vectors).
  virtual void prepare(std::span<const Index> elements) = 0;
  virtual void update() = 0;
  /// Displacement over the unknowns under the board's load.
  virtual void solve(std::span<double> u) = 0;
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

struct PeerKind {
  std::string name;      ///< "cholmod updown_solve"
  std::string settings;  ///< one sentence
  Index most_tets = 0;   ///< larger bodies take minutes an event or more memory than there is
  std::function<std::unique_ptr<Peer>(const TearingBoard&)> create;
};

/// OpenBLAS and Eigen; SuiteSparse.
[[nodiscard]] std::vector<PeerKind> eigen_peers();
[[nodiscard]] std::vector<PeerKind> cholmod_peers();

inline void copy(const Eigen::VectorXd& from, std::span<double> to) {
  std::copy_n(from.data(), to.size(), to.data());
}

/// The board's load over all unknowns.
[[nodiscard]] inline Eigen::VectorXd load_vector(const TearingBoard& board) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(board.problem->dof_count());
  for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
    f[board.load_dofs[i]] = board.load_values[i];
  }
  return f;
}

}  // namespace sunder::bench
