// SPDX-License-Identifier: Apache-2.0
// Which of a device's kinds of memory a buffer gets.
#include <gtest/gtest.h>

#include "gpu/vulkan/device.hpp"

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

// In the order of an integrated GPU's driver, uncached before cached.
TEST(MemoryTypes, TheFirstWishThatIsThereIsTaken) {
  const auto memory = of({kLocal, kLocal | kVisible, kVisible, kVisible | kCached});
  const auto on_host = [&](std::uint32_t allowed) {
    return vulkan::choose_memory_type(memory, allowed, {kVisible | kCached, kVisible});
  };
  EXPECT_EQ(on_host(0b1111), 3u);
  EXPECT_EQ(on_host(0b0111), 1u);
  EXPECT_EQ(on_host(0b0100), 2u);
  EXPECT_EQ(on_host(0b0001), std::nullopt);
  const auto mapped = [&](std::uint32_t allowed) {
    return vulkan::choose_memory_type(memory, allowed,
                                      {kLocal | kVisible | kCached, kLocal | kVisible, kLocal});
  };
  EXPECT_EQ(mapped(0b1111), 1u);
  EXPECT_EQ(mapped(0b1101), 0u);
  EXPECT_EQ(mapped(0b1100), std::nullopt);
}

TEST(MemoryTypes, CachedMemoryOfTheDeviceIsPreferredToUncached) {
  const auto memory = of({kLocal | kVisible, kLocal | kVisible | kCached});
  EXPECT_EQ(vulkan::choose_memory_type(memory, 0b11,
                                       {kLocal | kVisible | kCached, kLocal | kVisible, kLocal}),
            1u);
}

}  // namespace
}  // namespace sunder::test
