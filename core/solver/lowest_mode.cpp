// SPDX-License-Identifier: Apache-2.0
#include "solver/lowest_mode.hpp"

#include <cmath>
#include <memory>

#include "solver/finite_base.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {
namespace {

constexpr double kFirstShift = 1e-7;  // of the largest stiffness of an unknown
constexpr double kShiftGrowth = 8;
constexpr int kIterations = 30;
constexpr double kAlikeComponents = 1e-6;  // components of a mode that rounding may exchange

/// Each entry between 0 and 1, without a pattern (Weyl's sequence).
Eigen::VectorXd scattered(Eigen::Index n) {
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double x = 0.6180339887498949 * static_cast<double>(i + 1);
    v[i] = x - std::floor(x);
  }
  return v;
}

void point_upwards(Eigen::VectorXd& shape) {
  const double most = shape.cwiseAbs().maxCoeff();
  for (double x : shape) {
    if (std::abs(x) < (1 - kAlikeComponents) * most) continue;
    if (x < 0) shape = -shape;
    return;
  }
}

void hold_still(const RestingBody& body, Eigen::VectorXd& v) {
  for (Index d : body.body().problem.gripped_dofs()) v[d] = 0;
  for (Index d = 0; d < v.size(); ++d) {
    if (body.frozen()[d]) v[d] = 0;
  }
}

}  // namespace

LowestMode lowest_mode(const RestingBody& body, const std::vector<double>& u,
                       const fem::TangentPattern& pattern) {
  LowestMode mode;
  const Eigen::VectorXd diagonal =
      pattern.diagonal(pattern.tangent(body.body(), u, fem::Tangent::exact));
  const double stiffest = diagonal.cwiseAbs().maxCoeff();
  std::unique_ptr<FiniteBase> base;
  double shift = 0;
  while (!base && !(shift > stiffest)) {
    shift = shift == 0 ? kFirstShift * stiffest : kShiftGrowth * shift;
    ++mode.factors;
    try {
      base = std::make_unique<FiniteBase>(body.body(), u, fem::Tangent::exact, pattern,
                                          fem::Inertia{shift});
    } catch (const NumericalError&) {
    }
  }
  mode.shape = scattered(diagonal.size());
  if (!base) return mode;
  hold_still(body, mode.shape);
  mode.shape.normalize();
  Eigen::VectorXd next;
  for (int i = 0; i < kIterations; ++i) {
    base->solve(mode.shape, next);
    hold_still(body, next);
    const double length = next.norm();
    if (!(length > 0)) return mode;
    mode.stiffness = 1 / length - shift;
    mode.shape = next / length;
  }
  point_upwards(mode.shape);
  return mode;
}

}  // namespace sunder::solver
