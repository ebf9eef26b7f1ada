// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/tip_shift.hpp"

#include <Eigen/LU>
#include <cmath>

#include "body/assembly.hpp"
#include "fracture/crack_path.hpp"
#include "linear_algebra/factor.hpp"
#include "linear_algebra/nested_dissection.hpp"

namespace sunder::fracture {
namespace {

std::vector<double> preset_scale(const Problem& problem) {
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (const auto& elements : problem.crack_elements())
    for (Index e : elements) scale[e] = problem.scene().fracture.alpha;
  return scale;
}

/// Stiffness in which grips hold their nodes.
linear_algebra::SparseMatrix held_stiffness(const Problem& problem) {
  linear_algebra::SparseMatrix lower = fem::assemble_lower(problem, preset_scale(problem));
  std::vector<bool> held(static_cast<std::size_t>(problem.dof_count()), false);
  for (Index dof : problem.gripped_dofs()) held[dof] = true;
  lower.prune([&](Index row, Index column, double) {
    return row == column || !(held[row] || held[column]);
  });
  return lower;
}

/// Forces of a unit stress that nothing balances, in the elements round the tip: they open it,
/// shear it in its plane or out of it.
Eigen::VectorXd tip_forces(const Problem& problem, const Mat3& axes, int mode,
                           std::span<const Index> elements) {
  const Vec3 across = axes.row(1), other = axes.row(mode == kModeI ? 1 : mode == kModeII ? 0 : 2);
  const Mat3 stress = (across * other.transpose() + other * across.transpose()) / 2;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(problem.dof_count());
  for (Index e : elements) {
    const TetShape& shape = problem.shape(e);
    for (int a = 0; a < 4; ++a) {
      const Vec3 f = shape.volume * (stress * shape.gradient.col(a));
      for (int axis = 0; axis < 3; ++axis)
        if (const Index dof = problem.dof(problem.mesh().tets[e][a], axis); dof != kNone)
          force[dof] += f[axis];
    }
  }
  for (Index dof : problem.gripped_dofs()) force[dof] = 0;
  return force;
}

Vec3 vector_of(const IntensityFactors& f) { return {f.k_1, f.k_2, f.k_3}; }

}  // namespace

Eigen::MatrixXd intensity_per_shift(const Problem& problem, const Board& board, const Crack& crack,
                                    double reach, const MeasureTip& measure) {
  const auto tips = static_cast<Index>(crack.tips.size());
  Eigen::MatrixXd factors(kModes * tips, kModes * tips), shifts(kModes * tips, kModes * tips);
  const linear_algebra::Factor factor(held_stiffness(problem));
  std::vector<double> displacement(3 * problem.mesh().nodes.size());
  std::vector<Index> near;
  for (Index source = 0; source < tips; ++source) {
    const CrackTip& at = crack.tips[source];
    board.elements_within(at.position, reach, near);
    if (near.empty()) return {};
    const TipFrame frame{at.position, at.direction};
    for (int mode = 0; mode < kModes; ++mode) {
      const Eigen::VectorXd u =
          factor.solve(tip_forces(problem, frame.axes(board.plane()), mode, near));
      fem::scatter(problem, {u.data(), static_cast<std::size_t>(u.size())}, displacement);
      for (Index tip = 0; tip < tips; ++tip) {
        const ShiftedIntensity seen = measure(static_cast<std::size_t>(tip), displacement);
        factors.block<3, 1>(kModes * tip, kModes * source + mode) = vector_of(seen.factors);
        shifts.block<3, 1>(kModes * tip, kModes * source + mode) = vector_of(seen.shift);
      }
    }
  }
  return factors * shifts.inverse();
}

}  // namespace sunder::fracture
