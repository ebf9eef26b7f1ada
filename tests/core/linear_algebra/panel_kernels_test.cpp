// SPDX-License-Identifier: Apache-2.0
// One panel against a dense triangle, for widths and heights around full vectors. What lies after a
// column's end must not count.
#include "linear_algebra/panel_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

namespace sunder::linear_algebra {
namespace {

Eigen::MatrixXd random_panel(Index height, Index width) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> any(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(height, width, [&] { return any(generator); });
}

TEST(PanelKernels, SolveBackwardLikeADenseTriangle) {
  for (Index width : {1, 2, 3, 7, 8, 9, 15, 17, 24, 29}) {
    for (Index under : {0, 1, 7, 8, 13, 40}) {
      SCOPED_TRACE(std::to_string(width) + " wide, " + std::to_string(under) + " below");
      Eigen::MatrixXd panel = random_panel(width + under, width);
      panel.diagonal().array() += width;  // well conditioned
      std::vector<double> values(panel.data(), panel.data() + panel.size());
      values.resize(values.size() + kPanelLanes, 1e30);
      Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(width, -1, 2);
      const Eigen::VectorXd below = Eigen::VectorXd::LinSpaced(under, 1, -3);
      const Eigen::VectorXd reference =
          panel.topRows(width).triangularView<Eigen::Lower>().transpose().solve(
              x - panel.bottomRows(under).transpose() * below);
      std::vector<double> padded(below.data(), below.data() + under), solved;
      padded.resize(padded.size() + kPanelLanes, 0.0);
      solved.assign(static_cast<std::size_t>(width + kPanelLanes), 1e30);
      panel_backward(values.data(), width, width + under, x.data(), padded.data(), solved.data(),
                     values.data(), values.data());
      EXPECT_LE((x - reference).norm(), 1e-14 * (width + under) * reference.norm());
    }
  }
}

}  // namespace
}  // namespace sunder::linear_algebra
