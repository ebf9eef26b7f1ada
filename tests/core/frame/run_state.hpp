// SPDX-License-Identifier: Apache-2.0
// All that can be read of a simulation, to be held against another time's bit by bit.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "sunder/simulation.hpp"

namespace sunder::test {

struct RunState {
  explicit RunState(Simulation& simulation)
      : steps(simulation.steps_done()),
        displacement(simulation.displacement()),
        reactions(no_reactions(simulation) ? std::vector<Vec3>{} : simulation.reactions()),
        gone(simulation.backend().destroyed().begin(), simulation.backend().destroyed().end()),
        rows(simulation.destroyed()),
        corners(simulation.mesh().tets) {
    if (simulation.backend().needs().stress) stress = simulation.stress();
    for (const Crack& crack : simulation.cracks()) {
      paths.emplace_back(crack.path.begin(), crack.path.end());
    }
    for (const TipState& tip : simulation.tips()) {
      tips.push_back(tip.position);
      tips.emplace_back(tip.k.value_or(-1), tip.theta.value_or(-1), tip.ended ? 1 : 0);
    }
    for (const CrackFace& face : simulation.crack_faces()) {
      faces.push_back(face.left);
      faces.push_back(face.right);
    }
    if (simulation.problem().moves()) velocity = simulation.velocity();
    warnings = simulation.warnings();  // measuring tips may have found something
  }

  /// Of grips there are none before the first solution.
  static bool no_reactions(const Simulation& simulation) {
    return simulation.steps_done() == 0 && !simulation.problem().gripped_dofs().empty();
  }

  int steps;
  std::vector<Vec3> displacement, reactions, velocity, tips;
  std::vector<Voigt> stress;
  std::vector<std::uint8_t> gone;
  std::vector<DestroyedElement> rows;
  std::vector<std::string> warnings;
  std::vector<std::array<Index, 4>> corners;
  std::vector<std::array<Index, 3>> faces;  // of split cracks, both lips
  std::vector<std::vector<Vec2>> paths;
};

inline void expect_same_bits(const RunState& a, const RunState& b) {
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_TRUE(a.displacement == b.displacement);
  EXPECT_TRUE(a.reactions == b.reactions);
  EXPECT_TRUE(a.velocity == b.velocity);
  EXPECT_TRUE(a.stress == b.stress);
  EXPECT_TRUE(a.tips == b.tips);
  EXPECT_TRUE(a.gone == b.gone);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_TRUE(a.corners == b.corners);
  EXPECT_TRUE(a.faces == b.faces);
  EXPECT_TRUE(a.paths == b.paths);
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    EXPECT_EQ(a.rows[i].element, b.rows[i].element) << i;
    EXPECT_EQ(a.rows[i].step, b.rows[i].step) << i;
    EXPECT_EQ(a.rows[i].event, b.rows[i].event) << i;
    EXPECT_EQ(a.rows[i].ratio, b.rows[i].ratio) << i;
  }
}

}  // namespace sunder::test
