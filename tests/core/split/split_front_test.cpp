// SPDX-License-Identifier: Apache-2.0
// Split cracks through random meshes: every step moves the front or runs out, no element changes
// its shape, nothing comes loose but what a crack that has run through cuts off.
#include "fracture/split/split_front.hpp"

#include <numeric>
#include <random>

#include "split_bodies.hpp"

namespace sunder::fracture {
namespace {

struct Cracked : test::EdgeSplit {
  explicit Cracked(std::shared_ptr<const Problem> of)
      : EdgeSplit(*of), owned(of), problem(*owned) {}
  explicit Cracked(const Mesh& mesh)
      : Cracked(std::make_shared<const Problem>(test::board_scene(mesh, FractureModel::b))) {}

  /// Elements that share a face that is not open have its three nodes in common; no others have
  /// more nodes than the mesh gave them.
  void expect_joined() const {
    for (Index e = 0; e < problem.tet_count(); ++e) {
      for (int a = 0; a < 4; ++a) {
        EXPECT_EQ(body.in_mesh(body.corners(e)[static_cast<std::size_t>(a)]),
                  problem.mesh().tets[static_cast<std::size_t>(e)][static_cast<std::size_t>(a)]);
        const Face face{e, a};
        if (body.behind(face) == kNone) continue;
        auto mine = body.nodes(face), theirs = body.nodes(body.other_side(face));
        std::sort(mine.begin(), mine.end());
        std::sort(theirs.begin(), theirs.end());
        if (!body.open(face)) {
          EXPECT_EQ(mine, theirs);
        }
      }
    }
  }

  std::shared_ptr<const Problem> owned;
  const Problem& problem;
};

TEST(SplitFront, AStraightCrackOpensEveryFaceOnItsWay) {
  for (Index nz : {1, 2, 3}) {
    Cracked board(test::structured_board({10, 10, nz, 10, 10, static_cast<double>(nz)}));
    ASSERT_TRUE(board.begin(0).moved());
    double area = board.split.area;
    for (int i = 0; i < 40 && !board.crack.tips[0].ended; ++i) {
      const Vec2 before = board.crack.tips[0].position;
      const SplitStep step = board.advance(0);
      area += step.area;
      if (step.through) break;
      EXPECT_TRUE(step.moved());
      EXPECT_GT((board.crack.tips[0].position - before).x(), 0);
      EXPECT_EQ(board.pieces(), 1);
    }
    board.expect_joined();
    EXPECT_EQ(board.pieces(), 2);
    EXPECT_DOUBLE_EQ(area, board.split.area);
    EXPECT_DOUBLE_EQ(area, 10.0 * nz);  // the path lies in a plane of faces
  }
}

TEST(SplitFront, TissueThatDoesNotPartHoldsIt) {
  const auto volume = [](const Vec3& x) { return x.x() < 5 ? "board" : "frame"; };
  Cracked board(test::structured_board({10, 10, 2, 10, 10, 2}, volume));
  board.parts = [&](Index a, Index b) {
    return board.problem.breakable(a) && board.problem.breakable(b);
  };
  ASSERT_TRUE(board.begin(0).moved());
  SplitStep step;
  for (int i = 0; i < 40 && (step = board.advance(0)).moved();) ++i;
  EXPECT_TRUE(step.held);
  EXPECT_FALSE(step.through);
  EXPECT_LE(board.crack.tips[0].position.x(), 5 + 1e-9);
  EXPECT_GT(board.crack.tips[0].position.x(), 3.5);
  EXPECT_EQ(board.pieces(), 1);
  for (const Face& face : board.split.faces) {
    EXPECT_TRUE(board.problem.breakable(face.element));
    EXPECT_TRUE(board.problem.breakable(board.body.behind(face)));
  }
}

TEST(SplitFront, RandomStepsOnRandomMeshesNeverFail) {
  std::mt19937 random(20261124);
  std::uniform_real_distribution<double> kink(-70 * EIGEN_PI / 180, 70 * EIGEN_PI / 180);
  int advances = 0, through = 0, ligaments = 0;
  for (int run = 0; run < 60; ++run) {
    const Index nz = 1 + run % 3;
    Cracked board(test::shaken_board({12, 12, nz, 12, 12, static_cast<double>(nz)}, random, 0.25));
    const Vec2 box = board.board.plane().outline_max;
    ASSERT_TRUE(board.begin(kink(random) / 3).moved()) << run;
    for (int i = 0; i < 25; ++i) {
      const CrackTip before = board.crack.tips[0];
      const double turn = i % 3 == 0 ? kink(random) : kink(random) / 5;
      const SplitStep step = board.advance(turn);
      ++advances;
      if (step.through) {
        ++through;
        // At the rim, or where it has met itself.
        const double inside = board.board.plane().inside(before.position);
        const bool at_rim = inside < 3 * board.board.h();
        const auto& path = board.crack.path;
        const bool at_itself = std::any_of(path.begin(), path.end() - 3, [&](const Vec2& p) {
          return (p - before.position).norm() < 4 * board.board.h();
        });
        EXPECT_TRUE(at_rim || at_itself) << run << " " << i << " " << before.position.transpose();
        EXPECT_LE(board.pieces(), 2);
        ligaments += at_rim && board.pieces() == 1;
        break;
      }
      ASSERT_TRUE(step.moved()) << run << " " << i;
      ASSERT_GT(step.advance, 0) << run << " " << i;
      EXPECT_LE(board.pieces(), 1) << run << " " << i << " of " << box.transpose();
    }
    board.expect_joined();
  }
  EXPECT_GT(advances, 400);
  EXPECT_GT(through, 20);
  // After sharp kinks an element across the path may be left between the lips.
  EXPECT_LE(ligaments, through / 20);
}

}  // namespace
}  // namespace sunder::fracture
