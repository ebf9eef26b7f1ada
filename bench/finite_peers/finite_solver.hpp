// SPDX-License-Identifier: Apache-2.0
// The board at finite deformation that bench_finite solves by everyone, and what each of them
// offers: ours and what a user would pick instead, from the same state, to the same residual.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/tearing_board.hpp"
#include "body/hyperelastic.hpp"
#include "sunder/backend.hpp"

namespace sunder::bench {

/// What a solver gets: pulled at its corner with `newtons`, the first `gone` elements of the tear
/// destroyed, at rest at u.
struct FiniteStart {
  double newtons = 0;
  std::size_t gone = 0;
  std::vector<double> u;  ///< (3 * nodes); empty: not known
};

struct FiniteSetting {
  const TearingBoard& board;
  const Law& law;
  double tolerance;  ///< of the residual
  int threads;
  const FiniteStart& start;
};

/// A body of its own that is torn.
struct TornBody {
  TornBody(const TearingBoard& board, const Law& law)
      : laws(fem::one_law(*board.problem, law)),
        destroyed(board.problem->mesh().tets.size(), 0),
        body{*board.problem, laws, destroyed} {}
  TornBody(const TornBody&) = delete;  // the body reads its lists
  TornBody& operator=(const TornBody&) = delete;
  void destroy(std::span<const Index> elements) {
    for (Index e : elements) destroyed[e] = 1;
  }
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> destroyed;
  fem::HyperelasticBody body;
};

struct FiniteSolved {
  bool at_rest = false;
  /// Applications of a base or a preconditioner: of L-BFGS an iteration each, of conjugate
  /// gradients one of theirs.
  int back_solves = 0;
  int iterations = 0;  ///< states that were looked at one after the other
  int factors = 0;
};

class FiniteSolver {
 public:
  virtual ~FiniteSolver() = default;
  virtual void destroy(std::span<const Index> elements) = 0;
  virtual FiniteSolved solve(double newtons) = 0;
  [[nodiscard]] virtual const std::vector<double>& displacement() const = 0;
  /// Of the body; 1: destroyed, or hanging on nothing.
  [[nodiscard]] virtual std::span<const std::uint8_t> out() const = 0;
};

struct FiniteKind {
  std::string name;      ///< "newton cholmod"
  std::string settings;  ///< one sentence
  bool corotated_only = false;
  std::function<std::unique_ptr<FiniteSolver>(const FiniteSetting&)> create;
};

[[nodiscard]] FiniteKind newton_cholmod();
[[nodiscard]] FiniteKind newton_jacobi();
[[nodiscard]] FiniteKind newton_incomplete();
[[nodiscard]] FiniteKind projective_lbfgs();
[[nodiscard]] FiniteKind warped_stiffness();

/// The same force on every loaded unknown.
[[nodiscard]] inline Load corner_load(const TearingBoard& board, double newtons) {
  const auto count = board.load_dofs.size();
  return {board.load_dofs, std::vector<double>(count, -newtons / static_cast<double>(count)), {}};
}

}  // namespace sunder::bench
