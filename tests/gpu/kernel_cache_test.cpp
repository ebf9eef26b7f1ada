// SPDX-License-Identifier: Apache-2.0
// The driver's pipeline cache in a host's hands: whatever a host hands in, a backend is made, and
// what does not fit the device is named.
#include <algorithm>
#include <cstring>

#include "gpu/vulkan/kernel_cache.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"
#include "tearing_board.hpp"

namespace sunder::test {
namespace {

using Bytes = std::vector<std::byte>;

vulkan::PhysicalDevice some_device() {
  vulkan::PhysicalDevice device;
  device.vendor = 0x10de;
  device.device = 0x2330;
  for (std::uint8_t i = 0; i < VK_UUID_SIZE; ++i) device.cache_uuid[i] = i;
  return device;
}

/// What its driver would give: Vulkan's header and a hundred bytes of its own.
Bytes of_driver(const vulkan::PhysicalDevice& device) {
  VkPipelineCacheHeaderVersionOne header{};
  header.headerSize = sizeof(header);
  header.headerVersion = VK_PIPELINE_CACHE_HEADER_VERSION_ONE;
  header.vendorID = device.vendor;
  header.deviceID = device.device;
  std::ranges::copy(device.cache_uuid, header.pipelineCacheUUID);
  Bytes bytes(sizeof(header) + 100, std::byte{7});
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

TEST(KernelCacheBytes, OfTheSameDriverAreTaken) {
  const auto device = some_device();
  EXPECT_EQ(vulkan::why_not(vulkan::wrap(of_driver(device)), device), "");
}

TEST(KernelCacheBytes, OfOthersAreNamed) {
  const Bytes bytes = vulkan::wrap(of_driver(some_device()));
  vulkan::PhysicalDevice other = some_device();
  other.vendor = 0x1002;
  EXPECT_EQ(vulkan::why_not(bytes, other), "it is another device's");
  other = some_device();
  other.device = 1;
  EXPECT_EQ(vulkan::why_not(bytes, other), "it is another device's");
  other = some_device();
  other.cache_uuid.back() = 0;
  EXPECT_EQ(vulkan::why_not(bytes, other),
            "it is another driver's, or of another version of this one");
  Bytes of_another_version = of_driver(some_device());
  of_another_version[4] = std::byte{2};
  EXPECT_EQ(vulkan::why_not(vulkan::wrap(of_another_version), some_device()),
            "its header is of a version that is not known here");
  EXPECT_EQ(vulkan::why_not(vulkan::wrap(Bytes(31)), some_device()), "it lacks Vulkan's header");
}

TEST(KernelCacheBytes, AreRefusedWhereverTheyAreCutOrChanged) {
  const auto device = some_device();
  const Bytes bytes = vulkan::wrap(of_driver(device));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(vulkan::why_not(std::span(bytes).first(size), device), "it is cut") << size;
  }
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    Bytes changed = bytes;
    changed[at] ^= std::byte{0x10};
    EXPECT_NE(vulkan::why_not(changed, device), "") << at;
  }
  Bytes longer = bytes;
  longer.push_back({});
  EXPECT_EQ(vulkan::why_not(longer, device), "it goes on after its end");
}

using KernelCaches = WithVulkan<>;

/// Tears the board on a device of its own, with a cache.
std::vector<Vec3> tear(const std::shared_ptr<PipelineCache>& cache) {
  WatchedBackend watched(pulled_until_it_tears(), {});
  watched.options.cache = cache;
  Simulation simulation(watched.problem, watched.create());
  while (!simulation.done()) simulation.step();
  return simulation.displacement();
}

TEST_F(KernelCaches, ChangeNoBit) {
  const std::vector<Vec3> expected = tear(nullptr);
  const auto first = std::make_shared<PipelineCache>();
  EXPECT_EQ(tear(first), expected);
  const Bytes kept = first->bytes();
  ASSERT_FALSE(kept.empty());
  const auto second = std::make_shared<PipelineCache>(kept);
  EXPECT_EQ(tear(second), expected);
  EXPECT_EQ(second->ignored(), "");
  EXPECT_GE(second->bytes().size(), kept.size());
  Bytes cut = kept;
  cut.pop_back();
  const auto third = std::make_shared<PipelineCache>(cut);
  EXPECT_EQ(tear(third), expected);
  EXPECT_EQ(third->ignored(), "it is cut");
  EXPECT_GE(third->bytes().size(), kept.size()) << "made anew";
}

TEST_F(KernelCaches, AreReadWhileTheBackendLives) {
  const auto cache = std::make_shared<PipelineCache>();
  WatchedBackend watched(pulled_until_it_tears(), {});
  watched.options.cache = cache;
  EXPECT_TRUE(cache->bytes().empty());
  auto backend = watched.create();
  const Bytes living = cache->bytes();
  EXPECT_FALSE(living.empty());
  backend.reset();
  EXPECT_EQ(cache->bytes(), living);
}

// One that a lost device ends keeps what it had been handed at least.
TEST_F(KernelCaches, OutliveALostDevice) {
  const auto cache = std::make_shared<PipelineCache>();
  WatchedBackend watched(pulled_until_it_tears(), {});
  watched.options.cache = cache;
  watched.options.probe.submits_until_lost = 5;
  {
    Simulation simulation(watched.problem, watched.create());
    EXPECT_THROW(while (!simulation.done()) simulation.step(), sunder::DeviceLost);
  }
  EXPECT_FALSE(cache->bytes().empty());
}

}  // namespace
}  // namespace sunder::test
