// SPDX-License-Identifier: Apache-2.0
// Two split cracks that meet: what they cut off is one piece, and nothing comes loose beside it.
#include "split_bodies.hpp"

namespace sunder {
namespace {

constexpr double kSize = 20;

/// A second crack in the same body.
struct Other {
  Crack crack;
  fracture::SplitCrack split;
};

/// Until it has run out or met something; false: it was stopped by something else.
bool run(test::EdgeSplit& board, const std::function<double()>& turn) {
  for (int i = 0; i < 60; ++i) {
    const auto step = board.advance(turn());
    if (step.through) return true;
    if (!step.moved()) return false;
  }
  return false;
}

void swap_with(Other& other, test::EdgeSplit& board) {
  std::swap(board.crack, other.crack);
  std::swap(board.split, other.split);
}

class SplitMeeting : public ::testing::TestWithParam<Index> {};

INSTANTIATE_TEST_SUITE_P(Layers, SplitMeeting, ::testing::Values(1, 2, 3));

/// One stops inside; another runs into its side.
TEST_P(SplitMeeting, OneThatRunsIntoAnotherCutsOffOnePiece) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> small(-0.15, 0.15);
  for (int run_of = 0; run_of < 12; ++run_of) {
    const Problem problem(test::board_scene(
        test::shaken_board({20, 20, GetParam(), kSize, kSize, static_cast<double>(GetParam())},
                           random, 0.25),
        FractureModel::b));
    test::EdgeSplit board(problem);
    ASSERT_TRUE(board.begin(small(random)).moved());
    while (board.tip().x() < 14) ASSERT_TRUE(board.advance(small(random) / 3).moved());
    ASSERT_EQ(board.pieces(), 1);
    Other across;
    across.crack.id = 1;
    swap_with(across, board);
    ASSERT_TRUE(board.begin_at({7, 0}, EIGEN_PI / 2 + small(random)).moved());
    EXPECT_TRUE(run(board, [&] { return small(random) / 3; })) << run_of;
    // It ends at the other one, which lies in the middle.
    EXPECT_NEAR(board.tip().y(), kSize / 2, 4 * board.board.h()) << run_of;
    const auto pieces = board.piece_sizes();
    EXPECT_EQ(pieces.size(), 2U) << run_of;
    for (const auto& [first, size] : pieces) EXPECT_GE(size, 12) << run_of;
  }
}

/// Both from opposite sides, towards each other, in turn.
TEST_P(SplitMeeting, TwoThatFaceEachOtherMakeTwoPieces) {
  std::mt19937 random(static_cast<unsigned>(10 + GetParam()));
  for (int run_of = 0; run_of < 12; ++run_of) {
    const Problem problem(test::board_scene(
        test::shaken_board({20, 20, GetParam(), kSize, kSize, static_cast<double>(GetParam())},
                           random, 0.25),
        FractureModel::b));
    test::EdgeSplit board(problem);
    ASSERT_TRUE(board.begin(0).moved());
    Other facing;
    facing.crack.id = 1;
    swap_with(facing, board);
    ASSERT_TRUE(board.begin_at({kSize, kSize / 2}, EIGEN_PI).moved());
    for (int i = 0; i < 60 && board.pieces() == 1; ++i) {
      if (!board.crack.tips[0].ended) {
        const auto step = board.advance(0);
        board.crack.tips[0].ended = step.through || !step.moved();
      }
      swap_with(facing, board);
    }
    const auto pieces = board.piece_sizes();
    EXPECT_EQ(pieces.size(), 2U) << run_of;
    for (const auto& [first, size] : pieces) EXPECT_GE(size, 12) << run_of;
  }
}

}  // namespace
}  // namespace sunder
