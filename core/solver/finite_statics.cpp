// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_statics.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "body/stiffness_factor.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

// Share of the slope that a step must win (Nocedal and Wright 2006, 3.1).
constexpr double kArmijo = 1e-4;
constexpr double kRounding = 1e-13;  // of an energy that is summed over all elements
constexpr double kLeastPart = 1e-7;  // of a step, before the line search gives up
constexpr double kProbe = 1e-6;      // of the grips' motion, to feel what it pulls on

/// Known unknowns get equations of their own.
void uncouple(linear_algebra::SparseMatrix& lower, std::span<const Index> unknowns) {
  std::vector<std::uint8_t> known(static_cast<std::size_t>(lower.cols()), 0);
  for (Index d : unknowns) known[d] = 1;
  for (Index column = 0; column < lower.cols(); ++column) {
    for (linear_algebra::SparseMatrix::InnerIterator it(lower, column); it; ++it) {
      if (known[it.row()] || known[column]) it.valueRef() = it.row() == column ? 1 : 0;
    }
  }
}

/// The inverse Hessian by its base and the last steps (Nocedal 1980, two loops).
class Lbfgs {
 public:
  explicit Lbfgs(std::size_t pairs) : pairs_(pairs) {}
  template <class Base>
  [[nodiscard]] Eigen::VectorXd direction(const Eigen::VectorXd& r, const Base& base) const {
    Eigen::VectorXd q = -r;
    std::vector<double> a(pairs_of_.size());
    for (std::size_t i = pairs_of_.size(); i-- > 0;) {
      const Pair& p = pairs_of_[i];
      a[i] = p.s.dot(q) / p.sy;
      q -= a[i] * p.y;
    }
    Eigen::VectorXd du = base(q);
    for (std::size_t i = 0; i < pairs_of_.size(); ++i) {
      const Pair& p = pairs_of_[i];
      du += (a[i] - p.y.dot(du) / p.sy) * p.s;
    }
    return du;
  }
  /// A pair without curvature would make the Hessian indefinite.
  void learn(Eigen::VectorXd s, Eigen::VectorXd y) {
    const double sy = s.dot(y);
    if (!(sy > 1e-12 * s.norm() * y.norm())) return;
    if (pairs_of_.size() == pairs_) pairs_of_.pop_front();
    pairs_of_.push_back({std::move(s), std::move(y), sy});
  }

 private:
  struct Pair {
    Eigen::VectorXd s, y;
    double sy;
  };
  std::size_t pairs_;
  std::deque<Pair> pairs_of_;
};

}  // namespace

double FiniteStatics::residual(const State& state) const {
  const double left = state.r.norm();
  return left == 0 ? 0 : left / std::max(state.acting, floor_);
}

FiniteStatics::FiniteStatics(const fem::HyperelasticBody& body, FiniteStaticsOptions options)
    : body_(body),
      options_(options),
      u_(body.problem.dofs().size(), 0.0),
      reached_(target({{}, {}, std::vector<double>(body.problem.gripped_dofs().size(), 0.0)})),
      order_(fem::elimination_order(body.problem)) {}

FiniteStatics::Target FiniteStatics::target(const Load& load) const {
  Target of{Eigen::VectorXd::Zero(body_.problem.dof_count()), load.displacements};
  for (std::size_t i = 0; i < load.forces.size(); ++i)
    of.force[load.force_dofs[i]] = load.forces[i];
  return of;
}

/// Potential and residual of state.u.
void FiniteStatics::evaluate(const Target& target, State& state) const {
  const Problem& problem = body_.problem;
  std::vector<double> f(state.u.size());
  const double energy = fem::internal_forces(body_, state.u, f);
  state.r = -target.force;
  double work = 0, held = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const Index d = problem.dofs()[i];
    if (d == kNone) {
      held += f[i] * f[i];
      continue;
    }
    state.r[d] += f[i];
    work += target.force[d] * state.u[i];
  }
  for (Index d : problem.gripped_dofs()) {
    held += state.r[d] * state.r[d];
    state.r[d] = 0;
  }
  state.acting = std::sqrt(target.force.squaredNorm() + held);
  state.potential = energy - work;
}

void FiniteStatics::move(const State& from, double part, const Eigen::VectorXd& du,
                         State& to) const {
  to.u = from.u;
  for (std::size_t i = 0; i < to.u.size(); ++i) {
    const Index d = body_.problem.dofs()[i];
    if (d != kNone) to.u[i] += part * du[d];
  }
}

/// Halves the step until the potential falls; false: it does not.
bool FiniteStatics::line_search(const Target& target, const Eigen::VectorXd& du,
                                State& state) const {
  const double slope = state.r.dot(du);
  if (!(slope < 0)) return false;
  const double rounding = kRounding * std::abs(state.potential);
  for (double part = 1; part > kLeastPart; part /= 2) {
    State tried;
    move(state, part, du, tried);
    evaluate(target, tried);
    if (!(tried.potential <= state.potential + kArmijo * part * slope + rounding)) continue;
    state = std::move(tried);
    return true;
  }
  return false;
}

/// Makes a base; false: the tangent is not positive definite.
bool FiniteStatics::renew(const State& state, fem::Tangent kind, FiniteStaticsReport& report) {
  linear_algebra::SparseMatrix lower = fem::assemble_tangent(body_, state.u, kind);
  uncouple(lower, body_.problem.gripped_dofs());
  ++report.factors;
  try {
    base_.emplace(lower, order_);
  } catch (const NumericalError&) {
    base_.reset();
  }
  return base_.has_value();
}

/// The last state, its grips moved and the rest following as the base says: what a small share of
/// that motion adds to the forces tells what the whole would.
FiniteStatics::State FiniteStatics::predict(const Target& target) const {
  const auto gripped = body_.problem.gripped_dofs();
  State state{u_, {}};
  evaluate(target, state);
  if (target.grips == reached_.grips) return state;
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(state.r.size());
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    motion[gripped[g]] = target.grips[g] - reached_.grips[g];
  }
  State probe;
  move(state, kProbe, motion, probe);
  evaluate(target, probe);
  const Eigen::VectorXd following = base_->solve(-(state.r + (probe.r - state.r) / kProbe));
  State predicted;
  move(state, 1, motion + following, predicted);
  evaluate(target, predicted);
  return predicted;
}

bool FiniteStatics::by_lbfgs(const Target& target, State& state, FiniteStaticsReport& report) {
  Lbfgs hessian(static_cast<std::size_t>(options_.pairs));
  for (int i = 0; i < options_.most_back_solves; ++i) {
    if (residual(state) <= options_.residual) return true;
    const Eigen::VectorXd du =
        hessian.direction(state.r, [&](const Eigen::VectorXd& r) { return base_->solve(r); });
    ++report.back_solves;
    const State before = state;
    if (!line_search(target, du, state)) return false;
    Eigen::VectorXd s(du.size());
    for (std::size_t k = 0; k < state.u.size(); ++k) {
      const Index d = body_.problem.dofs()[k];
      if (d != kNone) s[d] = state.u[k] - before.u[k];
    }
    hessian.learn(std::move(s), state.r - before.r);
  }
  return residual(state) <= options_.residual;
}

/// With the exact tangent where it is positive definite, else with the projected one.
bool FiniteStatics::by_newton(const Target& target, State& state, FiniteStaticsReport& report) {
  for (int i = 0; i < options_.most_factors; ++i) {
    if (residual(state) <= options_.residual) return true;
    if (!renew(state, fem::Tangent::exact, report) &&
        !renew(state, fem::Tangent::projected, report)) {
      return false;
    }
    ++report.back_solves;
    if (!line_search(target, base_->solve(-state.r), state)) return false;
  }
  return residual(state) <= options_.residual;
}

bool FiniteStatics::approach(const Target& target, FiniteStaticsReport& report) {
  const int before = report.back_solves;
  if (!base_ && !renew({u_, {}}, fem::Tangent::projected, report)) return false;
  State state = predict(target);
  if (!std::isfinite(state.potential)) return false;
  if (!by_lbfgs(target, state, report) && !by_newton(target, state, report)) return false;
  report.residual = residual(state);
  u_ = state.u;
  if (report.back_solves - before > options_.renew_after) base_.reset();
  return true;
}

FiniteStaticsReport FiniteStatics::solve(const Load& load) {
  FiniteStaticsReport report;
  const Target begin = reached_, end = target(load);
  State state{u_, {}};
  evaluate(begin, state);
  floor_ = state.acting;  // else a body that returns to rest would never be at rest
  double step = 1;
  const double least = std::ldexp(1.0, -options_.most_halvings);
  while (report.share < 1) {
    const double share = std::min(1.0, report.share + step);
    Target next{begin.force + share * (end.force - begin.force), end.grips};
    for (std::size_t g = 0; g < next.grips.size(); ++g) {
      next.grips[g] = begin.grips[g] + share * (end.grips[g] - begin.grips[g]);
    }
    ++report.load_steps;
    if (approach(next, report)) {
      report.share = share;
      reached_ = std::move(next);
      continue;
    }
    base_.reset();  // of the last state at rest
    step /= 2;
    if (step < least) return report;
  }
  report.at_rest = true;
  return report;
}

}  // namespace sunder::solver
