// SPDX-License-Identifier: Apache-2.0
// The cost model counts the submits and dispatches that frames take: what it predicts of a GPU
// stands on them.
#include <algorithm>

#include "gpu_body.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using PredictedUse = WithVulkan<>;

/// Of frames of a kind: none takes more than predicted, and one as much.
struct Frames {
  void add(const gpu::DeviceUse& before, const gpu::DeviceUse& after,
           const solver::FrameSum& predicted) {
    const auto submits = static_cast<double>(after.submits - before.submits);
    EXPECT_LE(submits, predicted.submits);
    EXPECT_NEAR(static_cast<double>(after.dispatches - before.dispatches), predicted.dispatches, 1);
    EXPECT_GT(predicted.bytes, 0);
    EXPECT_GT(predicted.flops, 0);
    most = std::max(most, submits);
    of = predicted.submits;
  }
  double most = 0, of = -1;  // submits counted, predicted
};

// Memory that the host does not map, as on a discrete GPU.
TEST_F(PredictedUse, IsThatOfAFrame) {
  for (const Way& way :
       {Way{.route = Route::inverse}, Way{.route = Route::inverse, .inverts = true},
        Way{.route = Route::inverse, .damage = true}, Way{.route = Route::condensed},
        Way{.route = Route::condensed, .region = true},
        Way{.route = Route::condensed, .region = true, .damage = true}}) {
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? ", condensed" : ""));
    const auto problem = vulkan_problem(pulled_board(), way);
    gpu::VulkanOptions options;
    options.instance.validation = validated();
    options.probe = watched_probe();
    options.probe.as_gpu = true;
    if (way.inverts) options.invert_on_device = true;
    options.region_on_device = way.region;
    options.damage_on_device = way.damage;
    Needs needs;
    needs.stress = needs.yield = needs.damage = true;
    const auto backend = gpu::create(problem, needs, options);
    double force = -10;
    const auto frame = [&] {
      backend->set_load(corner_pull(*problem, Vec3(0, force *= 1.0009765625, 0)));
      static_cast<void>(backend->solve());
      static_cast<void>(backend->stress());
    };
    const auto crack = crack_sequence(*problem, 40, 10);
    std::size_t next = 0;
    frame();
    for (; next < 20; ++next) {  // so many that the device multiplies a region's columns
      backend->destroy({&crack[next], 1});
      frame();
    }
    Frames quiet, torn;
    for (; next < 24; ++next) {
      const solver::FrameCost cost = gpu::predicted(*backend);
      gpu::DeviceUse before = gpu::device_use(*backend);
      frame();
      quiet.add(before, gpu::device_use(*backend), cost.quiet);
      before = gpu::device_use(*backend);
      backend->destroy({&crack[next], 1});
      frame();
      torn.add(before, gpu::device_use(*backend), cost.fracture);
    }
    EXPECT_EQ(quiet.most, quiet.of);
    EXPECT_EQ(torn.most, torn.of);
    EXPECT_EQ(quiet.of, 1 + way.damage + way.region);
    const solver::FrameCost cost = gpu::predicted(*backend);
    EXPECT_GT(cost.fracture.ms, cost.quiet.ms);
    solver::FrameRates slow = solver::FrameRates{.submit = 1, .dispatch = 1};
    EXPECT_EQ(gpu::predicted(*backend, slow).quiet.submits, 0) << "nothing is apart from the host";
    slow.bytes = 1e9;
    EXPECT_GT(gpu::predicted(*backend, slow).quiet.ms, 3000);
  }
}

}  // namespace
}  // namespace sunder::test
