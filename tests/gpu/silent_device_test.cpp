// SPDX-License-Identifier: Apache-2.0
// A device that never answers: the wait for it has an end, and it counts as lost from then on.
#include <chrono>

#include "failover_backend.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "tearing_board.hpp"

namespace sunder::test {
namespace {

using SilentDevice = WithVulkan<>;

constexpr const char* kSays =
    "the Vulkan device does not answer: what it was given 0.001 s ago is not done; it counts as "
    "lost, and what it held is gone";

void set_silent(vulkan::DeviceProbe& probe, int after) {
  probe.submits_until_lost = after;
  probe.silent = true;
}

std::string lost_as(const std::function<void()>& f) {
  try {
    f();
  } catch (const sunder::DeviceLost& error) {
    return error.what();
  }
  return "no DeviceLost was thrown";
}

/// What it was given may still be at work: nothing of it is destroyed, which validation would see.
TEST_F(SilentDevice, IsLostAtOnceFromThenOn) {
  vulkan::InstanceOptions options;
  options.validation = validated();
  vulkan::DeviceProbe probe = watched_probe();
  set_silent(probe, 0);
  const auto device = watched_device(std::make_shared<vulkan::Instance>(options), probe);
  vulkan::Commands commands(*device);
  commands.begin();
  commands.end();
  for (int i = 0; i < 2; ++i) EXPECT_EQ(lost_as([&] { commands.submit(); }), kSays);
  EXPECT_EQ(lost_as([&] { commands.begin(); }), kSays) << "it may be at work";
  EXPECT_TRUE(device->queue().silent());
  EXPECT_EQ(device->queue().submits(), 0u);
  EXPECT_TRUE(options.messages->texts.empty());
}

TEST_F(SilentDevice, TheWaitThatRunsOutIsTheQueues) {
  vulkan::InstanceOptions options;
  const auto device = watched_device(std::make_shared<vulkan::Instance>(options), {});
  vulkan::DeviceFunctions vk = device->vk();
  VkQueue handle = VK_NULL_HANDLE;
  vk.GetDeviceQueue(device->handle(), static_cast<std::uint32_t>(device->physical().compute_family),
                    0, &handle);
  vk.WaitForFences = [](VkDevice, std::uint32_t, const VkFence*, VkBool32,
                        std::uint64_t nanoseconds) {
    return nanoseconds == 2'000'000'000 ? VK_TIMEOUT : VK_SUCCESS;
  };
  for (const int seconds : {1, 2}) {
    vulkan::Queue queue(vk, device->handle(), handle, {}, std::chrono::seconds(seconds));
    queue.submit({}, true);
    if (seconds == 1) {
      EXPECT_NO_THROW(queue.wait());
      EXPECT_EQ(queue.submits(), 1u);
    } else {
      EXPECT_NE(lost_as([&] { queue.wait(); }).find("what it was given 2 s ago is not done"),
                std::string::npos);
      EXPECT_NE(lost_as([&] { queue.submit({}, true); }).find("does not answer"),
                std::string::npos);
    }
    vk.DeviceWaitIdle(device->handle());
  }
}

/// A GPU has a minute, a processor that emulates one half an hour.
TEST(Patience, IsGenerous) {
  EXPECT_EQ(vulkan::kPatience, std::chrono::seconds(60));
  EXPECT_EQ(vulkan::kPatienceWithAProcessor, std::chrono::seconds(1800));
}

TEST_F(SilentDevice, TheCpuGoesOnFromTheLastFrame) {
  Scene scene = pulled_until_it_tears();
  scene.solver.backend = "cpu";
  const auto on_cpu = std::make_shared<const Problem>(scene);
  const auto create_cpu = [&] { return cpu_reference::create(on_cpu, needs_of(*on_cpu)); };
  const std::vector<Index> expected = destroyed_by(on_cpu, create_cpu());
  ASSERT_FALSE(expected.empty());
  int taken_over = 0;
  for (int after = 1; after < 1000; after += 2) {
    SCOPED_TRACE(after);
    WatchedBackend watched(scene, {});
    set_silent(watched.options.probe, after);
    std::unique_ptr<Backend> primary;
    try {
      primary = watched.create();
    } catch (const sunder::DeviceLost&) {
      continue;  // while it was being created
    }
    Simulation simulation(watched.problem,
                          with_failover(watched.problem, std::move(primary), create_cpu));
    while (!simulation.done()) simulation.step();
    std::vector<Index> destroyed;
    for (const DestroyedElement& d : simulation.destroyed()) destroyed.push_back(d.element);
    EXPECT_EQ(destroyed, expected);
    if (simulation.backend().info().backend == "vulkan") break;  // it never came to that
    EXPECT_NE(simulation.backend().info().why.find("the Vulkan device does not answer"),
              std::string::npos)
        << simulation.backend().info().why;
    ++taken_over;
  }
  EXPECT_GE(taken_over, 2);
}

}  // namespace
}  // namespace sunder::test
