// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_start.hpp"

#include <algorithm>

#include "material/singular_values.hpp"

namespace sunder::solver {
namespace {

constexpr double kNoTurn = 1e-6;      // [rad], about
constexpr double kMostSteps = 4;      // of the last change; farther nothing goes on as it went
constexpr double kMostMisfit = 0.25;  // of the next change

struct Motion {
  Vec3 from, to;
};

/// Of nodes all of whose axes are gripped; empty: a support holds something.
std::vector<Motion> motions(const Problem& problem, std::span<const double> u,
                            std::span<const double> grips) {
  std::vector<Motion> of;
  const auto gripped = problem.gripped_dofs();
  std::vector<std::uint8_t> used(problem.mesh().nodes.size(), 0);
  for (const auto& tet : problem.mesh().tets)
    for (Index n : tet) used[n] = 1;
  for (Index n = 0; n < problem.node_count(); ++n) {
    if (!used[n]) continue;
    Motion m{problem.mesh().nodes[n], problem.mesh().nodes[n]};
    int held = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem.dof(n, axis);
      if (d == kNone) return {};
      const auto at = std::ranges::lower_bound(gripped, d);
      if (at == gripped.end() || *at != d) continue;
      ++held;
      m.from[axis] += u[static_cast<std::size_t>(3 * n + axis)];
      m.to[axis] += grips[static_cast<std::size_t>(at - gripped.begin())];
    }
    if (held == 3) of.push_back(m);
  }
  return of;
}

}  // namespace

std::vector<double> follow_grips_rigidly(const Problem& problem, std::span<const double> u,
                                         std::span<const double> grips) {
  const std::vector<Motion> of = motions(problem, u, grips);
  if (of.size() < 3) return {};
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  for (const Motion& m : of) {
    from += m.from / static_cast<double>(of.size());
    to += m.to / static_cast<double>(of.size());
  }
  Mat3 sum = Mat3::Zero();
  for (const Motion& m : of) sum += (m.to - to) * (m.from - from).transpose();
  const Mat3 turn = polar(sum).rotation;
  if ((turn - Mat3::Identity()).norm() < kNoTurn) return {};
  std::vector<double> moved(u.begin(), u.end());
  for (Index n = 0; n < problem.node_count(); ++n) {
    if (problem.dof(n, 0) == kNone) continue;
    const Vec3& x = problem.mesh().nodes[n];
    const Vec3 there = turn * (x + Vec3(&u[static_cast<std::size_t>(3 * n)]) - from) + to - x;
    for (int axis = 0; axis < 3; ++axis) moved[3 * n + axis] = there[axis];
  }
  return moved;
}

double continuation(const FiniteTarget& before, const FiniteTarget& now, const FiniteTarget& next) {
  const auto parts = [](const FiniteTarget& a, const FiniteTarget& b) {
    const auto grips = static_cast<Eigen::Index>(a.grips.size());
    return std::pair<Eigen::VectorXd, Eigen::VectorXd>(
        b.force - a.force, Eigen::Map<const Eigen::VectorXd>(b.grips.data(), grips) -
                               Eigen::Map<const Eigen::VectorXd>(a.grips.data(), grips));
  };
  const auto last = parts(before, now), ahead = parts(now, next);
  // Each part by its own measure; both have to go on alike.
  double ratio = 0;
  for (const auto& [a, b] :
       {std::pair(&last.first, &ahead.first), std::pair(&last.second, &ahead.second)}) {
    const double square = a->squaredNorm();
    if (square == 0 && b->squaredNorm() == 0) continue;
    if (square == 0) return 0;
    const double times = a->dot(*b) / square;
    if ((*b - times * *a).norm() > kMostMisfit * b->norm()) return 0;
    if (ratio != 0 && !(times > 0.5 * ratio && times < 2 * ratio)) return 0;
    ratio = times;
  }
  return ratio > 0 && ratio <= kMostSteps ? ratio : 0;
}

}  // namespace sunder::solver
