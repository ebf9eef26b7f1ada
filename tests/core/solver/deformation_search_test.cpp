// SPDX-License-Identifier: Apache-2.0
// The largest strain and rotation that the stress kernel finds against a loop over all elements.
#include "solver/deformation_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "solver/stress_kernel.hpp"
#include "support/table1_board.hpp"

namespace sunder::solver {
namespace {

class DeformationSearchTest : public ::testing::Test {
 protected:
  std::shared_ptr<const Problem> problem_ = std::make_shared<Problem>(test::pulled_board());
  std::vector<double> u_ = std::vector<double>(problem_->dofs().size(), 0.0);
  std::vector<std::uint8_t> counts_ = std::vector<std::uint8_t>(problem_->mesh().tets.size(), 1);
  std::mt19937 generator_{5};

  [[nodiscard]] Deformation by_loop() const {
    Deformation all;
    for (Index e = 0; e < problem_->tet_count(); ++e) {
      if (!counts_[e]) continue;
      const Mat3 h = fem::displacement_gradient(*problem_, e, u_);
      const double strain = fem::principal_strain(h);
      if (std::abs(strain) > std::abs(all.strain)) all.strain = strain;
      all.rotation_deg = std::max(all.rotation_deg, fem::rotation_deg(h));
      all.inverted += (Mat3::Identity() + h).determinant() <= 0;
    }
    return all;
  }

  [[nodiscard]] Deformation by_kernel(const std::vector<Index>& destroyed,
                                      const std::vector<Index>& cut_off, int threads) const {
    StressKernel kernel(problem_, {}, threads);
    kernel.keep_deformation();
    kernel.destroy(destroyed);
    kernel.cut_off(cut_off);
    kernel.run(u_, {});
    return kernel.deformation(u_);
  }

  void add(const Mat3& gradient) {
    for (std::size_t n = 0; n < problem_->mesh().nodes.size(); ++n) {
      const Vec3 u = gradient * problem_->mesh().nodes[n];
      for (int axis = 0; axis < 3; ++axis) u_[3 * n + static_cast<std::size_t>(axis)] += u[axis];
    }
  }

  void expect_the_same(const std::vector<Index>& destroyed, const std::vector<Index>& cut_off) {
    for (Index e : destroyed) counts_[e] = 0;
    for (Index e : cut_off) counts_[e] = 0;
    const Deformation expected = by_loop();
    for (int threads : {1, 2, 3, 7}) {
      const Deformation found = by_kernel(destroyed, cut_off, threads);
      // Two principal strains as large, of opposite signs (pure shear), differ by rounding.
      EXPECT_NEAR(std::abs(found.strain), std::abs(expected.strain),
                  4e-8 * std::abs(expected.strain));
      // The loop sums grad u up in another order; under 1e-12 deg there is nothing but rounding.
      EXPECT_LE(found.rotation_deg, expected.rotation_deg * (1 + 1e-13) + 1e-12);
      EXPECT_GE(found.rotation_deg, expected.rotation_deg * (1 - 1e-3) - 1e-12);
      EXPECT_EQ(found.inverted, expected.inverted);
    }
  }
};

TEST_F(DeformationSearchTest, FindsWhatALoopFindsInRandomFields) {
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double size : {1e-9, 1e-3, 0.05, 0.2, 0.6, 3.0}) {  // mm, of edges of some 2 mm
    for (double& value : u_) value = size * any(generator_);
    expect_the_same({}, {});
  }
  EXPECT_GT(by_loop().inverted, 0);
}

TEST_F(DeformationSearchTest, FindsOnePlantedElementAnywhere) {
  for (Index e = 0; e < problem_->tet_count(); e += 61) {
    std::fill(u_.begin(), u_.end(), 0.0);
    u_[3 * static_cast<std::size_t>(problem_->mesh().tets[e][1])] = 0.5;
    expect_the_same({}, {});
  }
}

TEST_F(DeformationSearchTest, TurnsTheWholeBodyByThirtyDegrees) {
  const Mat3 r = Eigen::AngleAxisd(std::numbers::pi / 6, Vec3(1, 1, 4).normalized()).matrix();
  add(r - Mat3::Identity());
  expect_the_same({}, {});
  EXPECT_NEAR(by_kernel({}, {}, 1).rotation_deg, 30, 1e-6);
  EXPECT_NEAR(by_kernel({}, {}, 1).strain, std::sqrt(3) / 2 - 1, 1e-6);
}

/// Where all elements are alike but for rounding, and where they nearly are with one that stands
/// out by a little.
TEST_F(DeformationSearchTest, FindsTheLargestInUniformFieldsAndTies) {
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).matrix();
  const Mat3 stretch = Vec3(0.1, -0.04, -0.04).asDiagonal(),
             squeeze = Vec3(-0.2, -0.2, 0.1).asDiagonal();
  Mat3 shear = Mat3::Zero(), flip = Mat3::Identity();
  shear(0, 1) = 0.1;
  flip(2, 2) = -1;
  const Mat3 turned = turn - Mat3::Identity(), mirrored = turn * flip - Mat3::Identity();
  const Index planted = problem_->mesh().tets[500][0];
  for (const Mat3& gradient : {Mat3(Mat3::Zero()), stretch, squeeze, shear, turned, mirrored,
                               Mat3(turn * stretch + turned), Mat3(turn * shear + turned)}) {
    std::fill(u_.begin(), u_.end(), 0.0);
    add(gradient);
    expect_the_same({}, {});
    const Deformation before = by_kernel({}, {}, 1);
    for (const double more : {1e-6, 1e-3}) {
      u_[3 * static_cast<std::size_t>(planted)] += more;
      expect_the_same({}, {});
      EXPECT_GE(std::abs(by_kernel({}, {}, 1).strain), std::abs(before.strain) * (1 - 1e-9));
    }
  }
}

TEST_F(DeformationSearchTest, DestroyedElementsAndThoseCutOffDoNotCount) {
  std::uniform_real_distribution<double> any(-1, 1);
  for (double& value : u_) value = 0.01 * any(generator_);
  // A node that moves far with all its elements; half of them destroyed, half cut off.
  const Index far = problem_->mesh().tets[100][2];
  u_[3 * static_cast<std::size_t>(far) + 1] = 40;
  EXPECT_GT(by_kernel({}, {}, 1).strain, 1);
  EXPECT_GT(by_kernel({}, {}, 1).inverted, 0);
  std::vector<Index> destroyed, cut_off;
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    for (Index n : problem_->mesh().tets[e]) {
      if (n == far) (e % 2 == 0 ? destroyed : cut_off).push_back(e);
    }
  }
  expect_the_same(destroyed, cut_off);
  EXPECT_LT(std::abs(by_kernel(destroyed, cut_off, 1).strain), 0.1);
  EXPECT_EQ(by_kernel(destroyed, cut_off, 1).inverted, 0);
}

}  // namespace
}  // namespace sunder::solver
