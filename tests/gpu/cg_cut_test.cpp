// SPDX-License-Identifier: Apache-2.0
// Conjugate gradients on the device after a cut: a free piece and nodes that only destroyed
// elements hold stay finite, and the attached part stays right.
#include <cmath>

#include "gpu_body.hpp"

namespace sunder::test {
namespace {

using CgCut = WithVulkan<>;

/// Cells (i, j) of a board one cell thick; rows 3 and 4 of eight are cut out.
constexpr BoardShape kShape{6, 8, 1};

TEST_F(CgCut, TheAttachedPartStaysRightAndTheRestFinite) {
  for (const gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    Scene scene;
    scene.mesh = structured_board(kShape);
    scene.materials["board"] = {5, 0.4, 2.0};
    scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
    Way way;
    way.variant = variant;
    way.update = Update::automatic;
    way.route = Route::cg;
    Pair pair(std::move(scene), way);
    std::vector<Index> cut;
    std::vector<std::uint8_t> loose(pair.problem().mesh().tets.size(), 0);
    for (Index e = 0; e < pair.problem().tet_count(); ++e) {
      const Index row = e / 6 / kShape.nx;
      if (row == 3 || row == 4) cut.push_back(e);
      loose[e] = row < 5;
    }
    pair.load(pull(pair.problem(),
                   nodes_in(pair.problem().mesh(), {Vec3(9, 7, -1), Vec3(11, 9, 2)}),
                   Vec3(1, -2, 0.3)));
    const auto intact = pair.solve();
    EXPECT_LE(intact.u, kIntactTolerance);
    pair.destroy(cut);
    const auto errors = pair.solve(loose);
    EXPECT_LE(errors.u, kCutTolerance);
    EXPECT_LE(errors.stress, kCutTolerance);
    EXPECT_LE(errors.report.error, 1e-4);
    double largest = 0;
    for (double u : Pair::displacement(*pair.vulkan)) {
      ASSERT_TRUE(std::isfinite(u));
      largest = std::max(largest, std::abs(u));
    }
    EXPECT_LE(largest, 1e3);
  }
}

}  // namespace
}  // namespace sunder::test
