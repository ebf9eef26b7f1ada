// SPDX-License-Identifier: Apache-2.0
#include "solver/update_vectors.hpp"

#include <gtest/gtest.h>

#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

TEST(UpdateVectors, KeepTheStiffnessTakenOutWithFarFewerColumns) {
  const Problem problem(test::pulled_board());
  const std::vector<Index> elements = test::crack_sequence(problem, 100, 20);
  const fem::EventFactor event = fem::event_factor(problem, elements);
  const fem::EventFactor small = compressed(event);
  EXPECT_EQ(small.dofs, event.dofs);
  EXPECT_EQ(event.w.cols(), 600);
  EXPECT_LT(small.w.cols(), 260);
  const Eigen::MatrixXd taken = event.w * event.w.transpose();
  EXPECT_LE((small.w * small.w.transpose() - taken).norm(), 1e-13 * taken.norm());
}

TEST(UpdateVectors, KeepSoftElementsBesideStiffOnes) {
  Scene scene = test::pulled_board();
  scene.materials["upper"].young = 5e-3;  // 1e5 softer than the frame beside it
  const Problem problem(std::move(scene));
  // The whole upper edge of the tissue with the frame's lowest row.
  std::vector<Index> elements = test::elements_across(problem.mesh(), 44.0);
  for (Index e : test::elements_across(problem.mesh(), 46.0)) {
    if (std::find(elements.begin(), elements.end(), e) == elements.end()) elements.push_back(e);
  }
  const fem::EventFactor event = fem::event_factor(problem, elements);
  const fem::EventFactor small = compressed(event);
  const Eigen::VectorXd scale = event.w.rowwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() *
                                 (event.w * event.w.transpose() - small.w * small.w.transpose()) *
                                 scale.asDiagonal();
  EXPECT_LE(scaled.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(UpdateVectors, LeaveASingleElementAsItIs) {
  const Problem problem(test::pulled_board());
  const std::vector<Index> one{1000};
  EXPECT_EQ(compressed(fem::event_factor(problem, one)).w, fem::event_factor(problem, one).w);
}

}  // namespace
}  // namespace sunder::solver
