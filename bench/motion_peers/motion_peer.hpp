// SPDX-License-Identifier: Apache-2.0
// A step of motion as a user would else compute it: the same scheme in time, start, energy and
// forces, line search and end as the library's own (solver/finite_motion.cpp); a peer adds the
// direction, or a way of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/tearing_board.hpp"
#include "solver/finite_motion.hpp"

namespace sunder::bench {

/// The board with a grip at its corner that moves down, of tissue as dense as water.
struct MotionBoard {
  explicit MotionBoard(Index cells);
  [[nodiscard]] Load pulled(double down) const;  ///< [mm]

  Problem problem;
  std::vector<const Law*> laws;
  std::vector<double> node_mass, mass;  ///< per node, per unknown [t]
  std::vector<int> axis;                ///< of each gripped dof

 private:
  static Scene scene(Index cells);
};

struct MotionSolved {
  bool ended = false;  ///< by its tolerance, not by its cap
  int iterations = 0, factors = 0;
};

class MotionPeer {
 public:
  /// `tolerance`: of |residual| over all forces that act; `most`: iterations of a step.
  MotionPeer(const MotionBoard& board, double tolerance, int most);
  virtual ~MotionPeer() = default;

  void destroy(std::span<const Index> elements);
  /// From where the past ends, by BDF2 or, while `past.euler` counts, by backward Euler.
  MotionSolved step(const solver::FiniteMotionPast& past, const Load& load, double dt);
  [[nodiscard]] const std::vector<double>& displacement() const { return state_.u; }

 protected:
  /// state() <- the minimum, from where it is; the default: a line search along direction().
  virtual MotionSolved minimise(const solver::FiniteTarget& target);
  /// du = -H r of state(); false: there is none.
  virtual bool direction(const solver::FiniteTarget&, Eigen::VectorXd&) { return false; }
  virtual void begin() {}
  virtual void moved(const Eigen::VectorXd& /*s*/, const Eigen::VectorXd& /*y*/) {}
  virtual void body_changed() {}

  [[nodiscard]] bool at_end() const;
  [[nodiscard]] const MotionBoard& board() const { return board_; }
  [[nodiscard]] const fem::HyperelasticBody& body() const { return moving_.body(); }
  [[nodiscard]] const solver::FinitePotential& potential() const { return potential_; }
  [[nodiscard]] solver::FiniteState& state() { return state_; }
  [[nodiscard]] int most() const { return most_; }
  int factors_ = 0;  // of the step

 private:
  const MotionBoard& board_;
  std::vector<std::uint8_t> destroyed_;
  fem::HyperelasticBody torn_;
  solver::RestingBody moving_;
  solver::FinitePotential potential_;
  double tolerance_, energy_rounding_;
  int most_;
  std::vector<double> ahead_;
  solver::FiniteState state_, next_;
};

struct MotionKind {
  std::string name, settings;
  std::unique_ptr<MotionPeer> (*create)(const MotionBoard&, double tolerance);
};

[[nodiscard]] MotionKind motion_newton();
[[nodiscard]] MotionKind motion_projective();
[[nodiscard]] MotionKind motion_vertex_blocks();

}  // namespace sunder::bench
