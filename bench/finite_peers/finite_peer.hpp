// SPDX-License-Identifier: Apache-2.0
// What the peers share, so that methods are compared and not element loops: energy and forces by
// the library's vectorised pass, the start of a step, the line search and the end are those of the
// library's own solver (solver/finite_minimiser.cpp). A peer adds the direction.
#pragma once

#include <Eigen/Core>

#include "bench/finite_peers/finite_solver.hpp"
#include "body/hyperelastic_pass.hpp"
#include "solver/resting_body.hpp"

namespace sunder::bench {

class FinitePeer : public FiniteSolver {
 public:
  /// `most`: iterations of a step, before it counts as not found; a minute of the processors ends
  /// it too.
  FinitePeer(const FiniteSetting& setting, int most);

  void destroy(std::span<const Index> elements) final;
  FiniteSolved solve(double newtons) final;
  [[nodiscard]] const std::vector<double>& displacement() const final { return state_.u; }
  [[nodiscard]] std::span<const std::uint8_t> out() const final { return resting_.out(); }

 protected:
  /// du = -H r at `u`, `residual` relative as tolerance() is; false: there is none.
  virtual bool direction(const std::vector<double>& u, const Eigen::VectorXd& r, double residual,
                         Eigen::VectorXd& du) = 0;
  virtual void begin() {}
  virtual void moved(const Eigen::VectorXd& /*s*/, const Eigen::VectorXd& /*y*/) {}
  /// No step wins: true if the next direction can be another one.
  virtual bool give_way() { return false; }
  virtual void body_changed() {}

  [[nodiscard]] const fem::HyperelasticBody& body() const { return resting_.body(); }
  [[nodiscard]] const Problem& problem() const { return torn_.body.problem; }
  [[nodiscard]] std::span<const std::uint8_t> frozen() const { return resting_.frozen(); }
  [[nodiscard]] double tolerance() const { return tolerance_; }
  FiniteSolved found_;  // of the step that is on its way

 private:
  struct State {
    std::vector<double> u, f;
    Eigen::VectorXd r;
    double potential = 0, acting = 0;
  };
  void evaluate(State& state);
  void move(const State& from, double part, State& to) const;
  void extrapolate(double newtons);
  [[nodiscard]] bool line_search();

  TornBody torn_;
  solver::RestingBody resting_;
  fem::HyperelasticPass pass_;
  std::vector<Index> load_dofs_;
  double tolerance_, newtons_, step_ = 0, energy_rounding_ = 0;
  int most_;
  Eigen::VectorXd force_, du_, s_, y_;
  State state_, next_;
  std::vector<double> before_;  // the state before; empty: the body has changed since
};

}  // namespace sunder::bench
