// SPDX-License-Identifier: Apache-2.0
#include "solver/kept_pressures.hpp"

#include <cmath>

#include "body/pooled_law.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

// Tangents in a row that are not definite: the way out of there is not Newton's.
constexpr int kMostTurns = 1;
// Steps in a row that make the residual worse.
constexpr int kMostWorse = 1;

/// U'(J) + U''/V b . du of each patch at u.
std::vector<double> pressures_after(const fem::HyperelasticBody& body, std::span<const double> u,
                                    const Eigen::VectorXd& du) {
  const Problem& problem = body.problem;
  const fem::PatchVolumes volumes(body, u);
  std::vector<double> pressure(volumes.pressure().begin(), volumes.pressure().end());
  for (Index p = 0; p < body.pools()->count(); ++p) {
    const fem::PatchTangent of = fem::patch_tangent(
        body, p, u, volumes.stiffness()[static_cast<std::size_t>(p)], fem::Tangent::exact);
    if (of.b.size() == 0) continue;
    const std::vector<Index> nodes = body.pools()->nodes(problem, p);
    double grown = 0;
    for (std::size_t i = 0; i < 3 * nodes.size(); ++i) {
      const Index d = problem.dof(nodes[i / 3], static_cast<int>(i % 3));
      if (d != kNone) grown += of.b[static_cast<Eigen::Index>(i)] * du[d];
    }
    pressure[static_cast<std::size_t>(p)] += of.factor * grown;
  }
  return pressure;
}

/// False: the tangent is not positive definite.
bool find_step(const PressureNewton& by, const fem::PatchVolumes& volumes, fem::Tangent kind,
               const FiniteState& state, Eigen::VectorXd& du, int& factors) {
  ++factors;
  try {
    const linear_algebra::Factor factor(
        by.pattern.supernodes(),
        by.pattern.tangent(by.potential.resting().body(), state.u, kind, volumes));
    linear_algebra::SolveWork work;
    factor.solve(-state.r, du, work);
  } catch (const NumericalError&) {
    return false;
  }
  return true;
}

}  // namespace

bool newton_with_pressures(const PressureNewton& by, const FiniteTarget& target,
                           std::vector<double> pressure, double enough, int most,
                           FiniteState& state, int& factors) {
  const fem::HyperelasticBody& body = by.potential.resting().body();
  const double potential = state.potential;
  double before = by.minimiser.residual(state);
  Eigen::VectorXd du;
  int turns = 0, worse = 0;
  for (int i = 0; i < most; ++i) {
    const fem::PatchVolumes volumes(body, state.u, pressure);
    if (find_step(by, volumes, fem::Tangent::exact, state, du, factors)) {
      turns = 0;
    } else if (++turns > kMostTurns ||
               !find_step(by, volumes, fem::Tangent::projected, state, du, factors)) {
      return false;
    }
    by.potential.hold(du);
    pressure = pressures_after(body, state.u, du);
    by.potential.move(state.u, 1, du, state.u);
    by.potential.evaluate(target, false, state);
    const double residual = by.minimiser.residual(state);
    if (!std::isfinite(residual) || !std::isfinite(state.potential)) return false;
    if (residual <= enough) return state.potential <= potential;
    worse = i > 0 && residual > before ? worse + 1 : 0;  // the first one leaves a rest
    if (worse > kMostWorse) return false;
    before = residual;
  }
  return false;
}

}  // namespace sunder::solver
