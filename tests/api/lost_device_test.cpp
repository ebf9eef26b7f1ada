// SPDX-License-Identifier: Apache-2.0
// The host's device survives a failure at any submit of ours: nothing of ours is left on it, and
// the host goes on.
#include <cstdlib>

#include "api/vulkan_options.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

std::shared_ptr<const Problem> tearing_board() {
  Scene scene;
  scene.mesh = structured_board({3, 3, 1, 10, 10, 1});
  scene.materials["board"] = {5.0, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 10.01, 2)}, Axes{7}});
  const Box corner{Vec3(9.99, -0.01, -1), Vec3(10.01, 0.01, 2)};
  scene.instruments.push_back({"forceps", Pull{corner, Vec3(0, -40, 0)}, {}});
  scene.fracture.model = FractureModel::b;
  scene.solver.backend = "vulkan";
  return std::make_shared<const Problem>(std::move(scene));
}

/// Runs one step with a device that is lost at submit `at`. Returns whether it was reached.
bool fails(const std::shared_ptr<const Problem>& problem, gpu::VulkanOptions options, int at) {
  options.probe.submits_until_lost = at;
  try {
    Simulation simulation(problem, gpu::create(problem, needs_of(*problem), options));
    simulation.step();
    return false;
  } catch (const DeviceLost&) {
    return true;
  }
}

TEST(LostDevice, LeavesTheHostsDeviceAlone) {
  if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) {
    GTEST_SKIP() << "no Vulkan device is expected";
  }
  const VulkanHost host;
  const auto problem = tearing_board();
  int at = 0;
  while (fails(problem, options_of(host), at)) {
    host.run([](VkCommandBuffer) {});  // the host goes on
    ++at;
    ASSERT_LT(at, 2000);
  }
  EXPECT_GT(at, 3) << "the failures were injected at the submits of a whole tearing step";
  EXPECT_EQ(VulkanHost::calls.locks, VulkanHost::calls.submits);
}

}  // namespace
}  // namespace sunder::test
