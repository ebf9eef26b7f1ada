// SPDX-License-Identifier: Apache-2.0
// Static equilibrium at finite deformation (method.md "Finite deformation"): minimum of the energy
// less the work of the load, on a base that outlives the step.
//
// The base is the factor of the projected tangent at a recent equilibrium. L-BFGS on top of it
// finds the next one, with a line search on the energy; where that stalls Newton's method takes
// over, a new factor an iteration; where that ends nowhere the load is approached in smaller steps.
#pragma once

#include <optional>
#include <vector>

#include "body/hyperelastic.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

struct FiniteStaticsOptions {
  /// |internal forces - load| of free unknowns over all forces that act at the step's begin or end,
  /// whichever are larger.
  double residual = 1e-8;
  int pairs = 5;              ///< of L-BFGS
  int most_back_solves = 40;  ///< of one approach, before Newton
  int most_factors = 60;      ///< of one approach by Newton
  int most_halvings = 12;     ///< of the load's increment
  int renew_after = 8;        ///< back-solves of a step after which the base is renewed
};

/// How a step ended. `share` of the load's increment was reached: 1 at rest, less where no
/// equilibrium could be found beyond; the state is the last one at rest.
struct FiniteStaticsReport {
  bool at_rest = false;
  double share = 0;
  double residual = 0;
  int back_solves = 0, factors = 0, load_steps = 0;
};

class FiniteStatics {
 public:
  /// At rest at u = 0. The body must outlive it.
  explicit FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options = {});

  /// From the last state at rest to the load. Whether the equilibrium is stable is not looked at: a
  /// flat body that would buckle may stay flat.
  FiniteStaticsReport solve(const Load& load);
  /// (3 * nodes) [mm]
  [[nodiscard]] const std::vector<double>& displacement() const { return u_; }
  /// Elements of the body have been destroyed or its laws changed: what was at rest need not be.
  void body_changed() { base_.reset(); }

 private:
  struct Target {
    Eigen::VectorXd force;  // per unknown
    std::vector<double> grips;
  };
  struct State {
    std::vector<double> u;
    Eigen::VectorXd r;                 // internal forces - load; 0 at gripped unknowns
    double potential = 0, acting = 0;  // acting: |forces|, of the load and of what holds
  };
  [[nodiscard]] Target target(const Load& load) const;
  void evaluate(const Target& target, State& state) const;
  void move(const State& from, double part, const Eigen::VectorXd& du, State& to) const;
  [[nodiscard]] bool line_search(const Target& target, const Eigen::VectorXd& du,
                                 State& state) const;
  [[nodiscard]] double residual(const State& state) const;
  [[nodiscard]] bool renew(const State& state, fem::Tangent kind, FiniteStaticsReport& report);
  [[nodiscard]] State predict(const Target& target) const;
  [[nodiscard]] bool approach(const Target& target, FiniteStaticsReport& report);
  [[nodiscard]] bool by_lbfgs(const Target& target, State& state, FiniteStaticsReport& report);
  [[nodiscard]] bool by_newton(const Target& target, State& state, FiniteStaticsReport& report);

  const fem::HyperelasticBody& body_;
  FiniteStaticsOptions options_;
  std::vector<double> u_;
  Target reached_;
  double floor_ = 0;          // forces that acted at the step's begin [N]
  std::vector<Index> order_;  // of the factor
  std::optional<linear_algebra::Factor> base_;
};

}  // namespace sunder::solver
