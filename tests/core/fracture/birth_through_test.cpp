// SPDX-License-Identifier: Apache-2.0
// The option birth = "through" (method.md 4): a crack that starts in a board leaves nothing
// standing beside its first element.
#include <gtest/gtest.h>

#include <algorithm>

#include "fracture/board.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "support/table1_board.hpp"

namespace sunder {
namespace {

struct Torn {
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Simulation> simulation;
};

/// The paper's board at a corner load over its first rupture, ended after the first event.
Torn first_rupture(CrackBirth birth) {
  Scene scene = test::pulled_board(Vec3(0, -100, 0));
  scene.fracture.model = FractureModel::b;
  scene.fracture.birth = birth;
  scene.fracture.max_events = 1;
  Torn torn;
  torn.problem = std::make_shared<const Problem>(std::move(scene));
  torn.simulation = std::make_unique<Simulation>(
      torn.problem, create_backend(torn.problem, needs_of(*torn.problem)).backend);
  torn.simulation->step();
  return torn;
}

/// Live breakable elements with a node clearly on either side of the crack's first stretch and
/// their centroid between its ends: counted by brute force over the whole mesh.
int ligaments(const Torn& torn) {
  const Crack& crack = torn.simulation->cracks().at(0);
  const fracture::Board board(torn.problem->mesh(), {});
  const Vec2 origin = crack.path.front();
  const Vec2 along = crack.path.back() - origin;
  const Vec2 d = along.normalized(), left(-d.y(), d.x());
  int count = 0;
  for (Index e = 0; e < torn.problem->tet_count(); ++e) {
    if (torn.simulation->backend().destroyed()[e] || !torn.problem->breakable(e)) continue;
    const double rho = (board.centroid(e) - origin).dot(d);
    if (rho < 0 || rho > along.norm()) continue;
    double least = 0, largest = 0;
    for (Index n : torn.problem->mesh().tets[e]) {
      const double offset = (board.node(n) - origin).dot(left);
      least = std::min(least, offset);
      largest = std::max(largest, offset);
    }
    count += least < -0.25 * board.h() && largest > 0.25 * board.h();
  }
  return count;
}

TEST(BirthThrough, DefaultTakesOneElementAndLeavesItsNeighboursStanding) {
  const Torn torn = first_rupture(CrackBirth::element);
  EXPECT_EQ(torn.simulation->destroyed().size(), 1U);
  EXPECT_GT(ligaments(torn), 0);
}

TEST(BirthThrough, LeavesNoLigamentBesideTheFirstElement) {
  const Torn one = first_rupture(CrackBirth::element);
  const Torn all = first_rupture(CrackBirth::through);
  EXPECT_EQ(ligaments(all), 0);
  const auto& rows = all.simulation->destroyed();
  ASSERT_GT(rows.size(), 1U);
  EXPECT_EQ(rows.front().element, one.simulation->destroyed().front().element);
  for (const DestroyedElement& row : rows) {
    EXPECT_EQ(row.cause, Cause::mss);
    EXPECT_EQ(row.crack, 0);
    EXPECT_EQ(row.event, 0);
    ASSERT_TRUE(row.ratio.has_value());
    EXPECT_LE(*row.ratio, *rows.front().ratio);
  }
}

}  // namespace
}  // namespace sunder
