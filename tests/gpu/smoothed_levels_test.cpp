// SPDX-License-Identifier: Apache-2.0
// The levels over groups of nodes on the host: what they come to is the V-cycle step by step, which
// contracts in energy; motions that nothing resists, pieces apart, and how points are cut into
// parts.
#include "gpu/passes/smoothed_levels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numeric>
#include <random>

#include "gpu/passes/bisection.hpp"
#include "gpu/passes/node_groups.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

using gpu::GroupBlocks;
using gpu::Six;

class SmoothedLevels : public testing::Test {
 protected:
  double random() { return std::uniform_real_distribution(-1.0, 1.0)(generator_); }
  void join(GroupBlocks& matrix, Index a, Index b, double stiff = 1);
  GroupBlocks chain(Index count);

 private:
  std::mt19937 generator_{7};
};

/// (v_a - v_b)^T m (v_a - v_b) with m positive, `stiff` times.
void SmoothedLevels::join(GroupBlocks& matrix, Index a, Index b, double stiff) {
  Six root;
  for (double& value : root.reshaped()) value = random();
  const Six m = stiff * (root * root.transpose() + Six::Identity());
  matrix.at(a, a) += m;
  matrix.at(b, b) += m;
  matrix.at(a, b) -= m;
  matrix.at(b, a) -= m;
}

/// Groups in a row, held at the first, parts of it a thousand times as stiff.
GroupBlocks SmoothedLevels::chain(Index count) {
  GroupBlocks matrix(static_cast<std::size_t>(count), count);
  for (Index g = 0; g + 1 < count; ++g) join(matrix, g, g + 1, g % 7 < 3 ? 1000 : 1);
  matrix.at(0, 0) += Six::Identity();
  return matrix;
}

GroupBlocks aggregates_of(Index count, Index size) {
  const Index aggregates = (count + size - 1) / size;
  GroupBlocks motions(static_cast<std::size_t>(count), aggregates);
  for (Index g = 0; g < count; ++g) motions.at(g, g / size) = Six::Identity();
  return motions;
}

Eigen::MatrixXd product(const gpu::SmoothedLevels& levels) {
  const Eigen::MatrixXd q = levels.prolongation.dense();
  return levels.smoother.dense() + q * levels.inverse * q.transpose();
}

Eigen::VectorXd energies(const Eigen::MatrixXd& b, const Eigen::MatrixXd& k) {
  const Eigen::MatrixXd root = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).operatorSqrt();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(root * b * root).eigenvalues();
}

TEST_F(SmoothedLevels, AreAVCycleStepByStep) {
  const GroupBlocks stiffness = chain(30);
  const Eigen::MatrixXd k = stiffness.dense(),
                        b = product(smoothed_levels(stiffness, aggregates_of(30, 5)));
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(k.rows(), k.cols());
  for (Eigen::Index g = 0; g < 30; ++g) {
    j.block<6, 6>(6 * g, 6 * g) = k.block<6, 6>(6 * g, 6 * g).inverse();
  }
  // w from what B does to a vector that the prolongation cannot reach is not to be had: from S.
  const Eigen::MatrixXd s = smoothed_levels(stiffness, aggregates_of(30, 5)).smoother.dense();
  const double largest = (j * k).eigenvalues().real().maxCoeff();
  const Eigen::MatrixXd far = s.block<6, 6>(0, 6);  // -w^2 J_0 K_01 J_1
  const double w = std::sqrt((far.norm()) / (j * k * j).block<6, 6>(0, 6).norm());
  EXPECT_GE(w * largest, 1.2);
  EXPECT_LE(w * largest, 1.6) << "of the power iteration's estimate";

  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(k.rows(), k.cols());
  const Eigen::MatrixXd p = (identity - w * j * k) * aggregates_of(30, 5).dense();
  const Eigen::MatrixXd coarse = p * (p.transpose() * k * p).inverse() * p.transpose();
  Eigen::VectorXd y(k.rows());
  for (double& value : y) value = random();
  Eigen::VectorXd x = w * j * y;
  x += coarse * (y - k * x);
  x += w * j * (y - k * x);
  EXPECT_LE((b * y - x).norm(), 1e-8 * x.norm());
}

TEST_F(SmoothedLevels, AreSymmetricAndContractInEnergy) {
  for (const Index size : {1, 4, 30}) {
    const GroupBlocks stiffness = chain(30);
    const Eigen::MatrixXd b = product(smoothed_levels(stiffness, aggregates_of(30, size)));
    EXPECT_LE((b - b.transpose()).norm(), 1e-12 * b.norm());
    const Eigen::VectorXd of = energies(b, stiffness.dense());
    EXPECT_GT(of.minCoeff(), size == 30 ? 1e-6 : 1e-2) << size;
    EXPECT_LT(of.maxCoeff(), 1 + 1e-6) << size;
  }
}

TEST_F(SmoothedLevels, MotionsThatNothingResistsAreLeftOut) {
  // Supports take one group's shifts and another's all away: rows and columns of zeros.
  GroupBlocks stiffness = chain(12);
  const auto hold = [&](Index held, Index first) {
    for (Index g = 0; g < 12; ++g) {
      if (std::abs(g - held) > 1) continue;
      stiffness.at(held, g).middleRows(first, 6 - first).setZero();
      stiffness.at(g, held).middleCols(first, 6 - first).setZero();
    }
  };
  hold(4, 3);
  hold(8, 0);
  const Eigen::MatrixXd b = product(smoothed_levels(stiffness, aggregates_of(12, 4)));
  EXPECT_TRUE(b.allFinite());
  Eigen::VectorXd y(b.rows());
  for (double& value : y) value = random();
  y.segment<3>(6 * 4 + 3).setZero();
  y.segment<6>(6 * 8).setZero();
  const Eigen::VectorXd x = b * y, of_x = stiffness.dense() * x;
  EXPECT_GT(x.dot(y), 0);
  EXPECT_LT(x.norm(), 1e3 * y.norm()) << "nothing is divided by rounding";
  EXPECT_LE(x.dot(of_x), (1 + 1e-6) * x.dot(y)) << "energy";
}

TEST_F(SmoothedLevels, APieceThatHardlyAnythingHoldsIsSolvedByItsAggregate) {
  GroupBlocks stiffness = chain(13);
  // The last is a piece that has come off: its bond to the others is as nothing.
  stiffness.at(11, 12).setZero();
  stiffness.at(12, 11).setZero();
  stiffness.at(12, 12) = 1e-8 * Six::Identity();
  GroupBlocks motions(13, 4);
  for (Index g = 0; g < 13; ++g) motions.at(g, g / 4) = Six::Identity();
  const Eigen::VectorXd of =
      energies(product(smoothed_levels(stiffness, motions)), stiffness.dense());
  EXPECT_GT(of.minCoeff(), 1e-2);
  EXPECT_LT(of.maxCoeff(), 1 + 1e-6);
}

TEST_F(SmoothedLevels, AnEmptyBodyHasNone) {
  const gpu::SmoothedLevels levels = smoothed_levels(GroupBlocks(0, 0), GroupBlocks(0, 0));
  EXPECT_EQ(levels.smoother.count(), 0u);
  EXPECT_EQ(levels.inverse.size(), 0);
}

using Bisection = SmoothedLevels;  // for its random numbers

TEST_F(Bisection, PartsAreOfEqualSizeAndWhole) {
  std::vector<Vec3> x;
  for (int n = 0; n < 1000; ++n) x.emplace_back(10 * random(), random(), 3 * random());
  x[10] = x[11] = x[12];  // as points of one place may be
  std::vector<Index> points(x.size());
  std::iota(points.begin(), points.end(), 0);
  for (const Index count : {1, 2, 7, 64, 1000}) {
    std::vector<std::vector<Index>> parts;
    gpu::bisect(points, count, 1, x, parts);
    EXPECT_EQ(std::ssize(parts), count);
    std::vector<int> found(x.size(), 0);
    for (const auto& part : parts) {
      EXPECT_TRUE(std::ranges::is_sorted(part));
      EXPECT_NEAR(static_cast<double>(part.size()), 1000.0 / count, 0.02 * 1000 / count + 2);
      for (Index n : part) ++found[static_cast<std::size_t>(n)];
    }
    EXPECT_EQ(std::ranges::count(found, 1), std::ssize(found));
  }
  std::vector<std::vector<Index>> parts;
  gpu::bisect(points, 1000, 4, x, parts);
  for (const auto& part : parts) EXPECT_GE(part.size(), 4u);
}

/// Elements of a board one cell thick whose cells lie in a square, without those of another.
std::vector<Index> square(const BoardShape& shape, Index low, Index high, Index inner_low = 0,
                          Index inner_high = 0) {
  std::vector<Index> found;
  for (Index e = 0; e < 6 * shape.nx * shape.ny; ++e) {
    const Index x = e / 6 % shape.nx, y = e / 6 / shape.nx;
    const auto lies = [&](Index from, Index to) {
      return std::min(x, y) >= from && std::max(x, y) < to;
    };
    if (lies(low, high) && !lies(inner_low, inner_high)) found.push_back(e);
  }
  return found;
}

TEST(NodeGroups, AreOfThePiecesThatTheyWereMadeOf) {
  const BoardShape shape{30, 30, 1, 50, 50, 2.5};
  Scene scene;
  scene.mesh = structured_board(shape);
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 49.9, -1), Vec3(51, 51, 3)}, Axes{7}});
  const Problem problem(std::move(scene));
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  const auto destroy = [&](const std::vector<Index>& elements) {
    for (Index e : elements) destroyed[static_cast<std::size_t>(e)] = 1;
  };
  gpu::NodeGroups groups(problem, 200, 64, false);
  EXPECT_TRUE(groups.make(groups.pieces(destroyed)));
  EXPECT_EQ(groups.count(), 961u * 2 / 16);
  EXPECT_FALSE(groups.make(groups.pieces(destroyed)));

  destroy({0, 1, 2, 3, 4, 5});  // at a corner: nodes go, the piece stays
  EXPECT_TRUE(groups.are_of(groups.pieces(destroyed)));
  destroy(square(shape, 3, 12, 4, 11));
  EXPECT_FALSE(groups.are_of(groups.pieces(destroyed))) << "one has come off";
  EXPECT_TRUE(groups.make(groups.pieces(destroyed)));
  ASSERT_EQ(groups.of_pieces().size(), 2u);
  EXPECT_EQ(groups.of_pieces()[1], 8u) << "its 128 nodes have groups of their own";
  EXPECT_TRUE(groups.are_of(groups.pieces(destroyed)));

  auto gone = destroyed;
  destroy(square(shape, 4, 11));
  EXPECT_TRUE(groups.are_of(groups.pieces(destroyed))) << "it is destroyed";
  destroy(square(shape, 15, 26, 16, 25));
  ASSERT_EQ(groups.pieces(destroyed).size(), 2u);
  EXPECT_FALSE(groups.are_of(groups.pieces(destroyed))) << "as many, but another one";
  // More pieces than may have groups.
  gpu::NodeGroups few(problem, 200, 1, false);
  EXPECT_TRUE(few.make(few.pieces(gone)));
  EXPECT_EQ(few.of_pieces().size(), 1u);
  EXPECT_TRUE(few.are_of(few.pieces(gone)));
}

}  // namespace
}  // namespace sunder::test
