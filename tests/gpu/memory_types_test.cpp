// SPDX-License-Identifier: Apache-2.0
// Which of a device's kinds of memory a buffer gets.
#include <gtest/gtest.h>

#include "gpu/vulkan/buffer.hpp"

namespace sunder::test {
namespace {

constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
                                kVisible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                           VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                                kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

VkPhysicalDeviceMemoryProperties of(std::initializer_list<VkMemoryPropertyFlags> types) {
  VkPhysicalDeviceMemoryProperties memory{};
  for (const VkMemoryPropertyFlags flags : types) {
    memory.memoryTypes[memory.memoryTypeCount++].propertyFlags = flags;
  }
  return memory;
}

std::optional<std::uint32_t> type(const VkPhysicalDeviceMemoryProperties& memory,
                                  vulkan::Placement placement, bool maps,
                                  std::uint32_t allowed = ~0u) {
  return vulkan::choose_memory_type(memory, allowed, vulkan::memory_wishes(placement, maps));
}

// In the order of an integrated GPU's driver, uncached before cached.
TEST(MemoryTypes, TheFirstWishThatIsThereIsTaken) {
  using enum vulkan::Placement;
  const auto memory = of({kLocal, kLocal | kVisible, kVisible, kVisible | kCached});
  for (const vulkan::Placement read : {host, staging}) {
    EXPECT_EQ(type(memory, read, true), 3u) << "what the host reads is cached";
    EXPECT_EQ(type(memory, read, true, 0b0111), 1u);
    EXPECT_EQ(type(memory, read, true, 0b0100), 2u);
    EXPECT_EQ(type(memory, read, true, 0b0001), std::nullopt);
  }
  EXPECT_EQ(type(memory, device, true), 1u);
  EXPECT_EQ(type(memory, device, true, 0b1101), 0u);
  EXPECT_EQ(type(memory, device, true, 0b1100), std::nullopt);
  EXPECT_EQ(type(memory, device, false), 0u);
}

TEST(MemoryTypes, CachedMemoryOfTheDeviceIsPreferredToUncached) {
  const auto memory = of({kLocal | kVisible, kLocal | kVisible | kCached});
  EXPECT_EQ(type(memory, vulkan::Placement::device, true), 1u);
  EXPECT_EQ(type(memory, vulkan::Placement::sent, true), 1u);
}

// A discrete GPU's heaps: its memory, the host's, and a window into the first or all of it.
TEST(MemoryTypes, WhatTheHostSendsIsTheDevicesWhereItMapsAllOfThat) {
  using enum vulkan::Placement;
  auto memory = of({kLocal, kVisible, kVisible | kCached, kLocal | kVisible});
  memory.memoryHeapCount = 3;
  memory.memoryHeaps[0] = {VkDeviceSize{24} << 30, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
  memory.memoryHeaps[1] = {VkDeviceSize{64} << 30, 0};
  memory.memoryHeaps[2] = {VkDeviceSize{256} << 20, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
  for (const std::uint32_t t : {1, 2}) memory.memoryTypes[t].heapIndex = 1;
  memory.memoryTypes[3].heapIndex = 2;
  EXPECT_FALSE(vulkan::maps_its_memory(memory)) << "a window";
  EXPECT_EQ(type(memory, device, false), 0u);
  EXPECT_EQ(type(memory, sent, false), 2u);
  memory.memoryTypes[3].heapIndex = 0;
  EXPECT_TRUE(vulkan::maps_its_memory(memory));
  EXPECT_EQ(type(memory, device, true), 3u);
  EXPECT_EQ(type(memory, sent, true), 3u);
  EXPECT_EQ(type(memory, host, true), 2u);
}

}  // namespace
}  // namespace sunder::test
