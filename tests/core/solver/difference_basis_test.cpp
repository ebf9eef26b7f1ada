// SPDX-License-Identifier: Apache-2.0
#include "solver/difference_basis.hpp"

#include <gtest/gtest.h>

#include "body/event_factor.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

/// B U over all unknowns.
Eigen::MatrixXd expanded(const Problem& problem, DifferenceBasis& basis, Index element) {
  std::vector<Index> rows;
  linear_algebra::RowMajor u;
  basis.coordinates(element, rows, u);
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(problem.dof_count(), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Difference& d = basis.differences()[static_cast<std::size_t>(rows[i])];
    const auto row = u.row(static_cast<Eigen::Index>(i)).head<6>();
    w.row(d.dof) += row;
    if (d.other != kNone) w.row(d.other) -= row;
  }
  return w;
}

Eigen::MatrixXd direct(const Problem& problem, Index element) {
  const fem::EventFactor event = fem::event_factor(problem, {&element, 1});
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(problem.dof_count(), 6);
  w(event.dofs, Eigen::all) = event.w;
  return w;
}

TEST(DifferenceBasis, CarriesTheUpdateVectorsOfEveryElement) {
  const Problem problem(test::pulled_board());
  for (const auto& sequence :
       {test::crack_sequence(problem, 150, 8), test::scattered_sequence(problem, 150)}) {
    DifferenceBasis basis(problem);
    for (Index e : sequence) basis.add(e);
    for (Index e : sequence) {
      const Eigen::MatrixXd w = direct(problem, e);
      EXPECT_LE((expanded(problem, basis, e) - w).norm(), 1e-14 * w.norm()) << "element " << e;
    }
  }
}

TEST(DifferenceBasis, CarriesElementsAtSupports) {
  const Problem problem(test::pulled_board());
  DifferenceBasis basis(problem);
  std::vector<Index> held;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    for (Index n : problem.mesh().tets[e]) {
      if (problem.dof(n, 0) == kNone && (held.empty() || held.back() != e)) held.push_back(e);
    }
  }
  ASSERT_GT(held.size(), 10u);
  for (Index e : held) basis.add(e);
  for (Index e : held) {
    const Eigen::MatrixXd w = direct(problem, e);
    EXPECT_LE((expanded(problem, basis, e) - w).norm(), 1e-14 * w.norm()) << "element " << e;
  }
}

TEST(DifferenceBasis, GrowsWithTheNodesAndNotWithTheElements) {
  const Problem problem(test::pulled_board());
  DifferenceBasis basis(problem);
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(problem.dof_count()), 0);
  std::size_t unknowns = 0;
  for (Index e : test::crack_sequence(problem, 200, 8)) {
    basis.add(e);
    for (Index n : problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        if (d != kNone && !seen[d]) ++unknowns, seen[d] = 1;
      }
    }
    ASSERT_LE(basis.differences().size(), unknowns);
  }
  EXPECT_LT(unknowns, 500u);
}

TEST(DifferenceBasis, IsTheSameAfterShrinking) {
  const Problem problem(test::pulled_board());
  const auto sequence = test::crack_sequence(problem, 80, 8);
  DifferenceBasis basis(problem), other(problem);
  for (Index e : sequence) basis.add(e);
  for (std::size_t i = 0; i < 40; ++i) other.add(sequence[i]);
  basis.shrink(other.differences().size());
  std::vector<Index> rows, other_rows;
  linear_algebra::RowMajor u, other_u;
  for (std::size_t i = 0; i < 40; ++i) {
    basis.coordinates(sequence[i], rows, u);
    other.coordinates(sequence[i], other_rows, other_u);
    ASSERT_EQ(rows, other_rows);
    const auto n = static_cast<Eigen::Index>(rows.size());
    EXPECT_EQ(u.topLeftCorner(n, 8), other_u.topLeftCorner(n, 8));
  }
}

}  // namespace
}  // namespace sunder::solver
