// SPDX-License-Identifier: Apache-2.0
// Buffers of a host's own for a body's surface, with margins and gaps that nothing may write to.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "api/vulkan_host.hpp"

namespace sunder::test {

/// What a host lends: places and normals side by side in one buffer, whatever else in its own.
class LentBuffers {
 public:
  static constexpr std::uint32_t kVertex = 32;  // bytes: place, a gap, normal, a gap
  static constexpr std::uint64_t kNormalAt = 16;
  static constexpr std::uint32_t kValues = 20;  // bytes: four numbers, a gap
  LentBuffers(const VulkanHost& host, std::uint64_t nodes, std::uint64_t triangles,
              std::uint64_t vertices)
      : host_(host),
        vertices_(host.allocate(kBefore + kVertex * nodes + kAfter, kUsage)),
        triangles_(host.allocate(kBefore + 12 * triangles + kAfter, kUsage)),
        facts_(host.allocate(kBefore + 12 * triangles + kAfter, kUsage)),
        skin_(host.allocate(kBefore + 12 * vertices + kAfter, kUsage)),
        lives_(host.allocate(kBefore + 4 * vertices + kAfter, kUsage)),
        values_(host.allocate(kBefore + kValues * triangles + kAfter, kUsage)) {
    surface.places = items(vertices_, 0, kVertex * nodes);
    surface.normals = items(vertices_, kNormalAt, kVertex * nodes - kNormalAt);
    surface.places.stride = surface.normals.stride = kVertex;
    surface.triangles = items(triangles_, 0, 12 * triangles);
    surface.facts = items(facts_, 0, 12 * triangles);
    surface.values = items(values_, 0, kValues * triangles);
    surface.values.stride = kValues;
    if (vertices == 0) return;
    surface.skin = items(skin_, 0, 12 * vertices);
    surface.skin_lives = items(lives_, 0, 4 * vertices);
  }
  ~LentBuffers() {
    for (const auto& memory : {vertices_, triangles_, facts_, skin_, lives_, values_}) {
      host_.free(memory);
    }
  }
  LentBuffers(const LentBuffers&) = delete;
  LentBuffers& operator=(const LentBuffers&) = delete;

  template <class T>
  [[nodiscard]] static std::vector<T> read(const sunder_vulkan_items& items,
                                           const VulkanHost::Memory& memory, std::size_t count,
                                           std::size_t each) {
    const std::size_t stride = items.stride > 0 ? items.stride : each * sizeof(T);
    std::vector<T> values(count * each);
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(values.data() + each * i,
                  static_cast<const std::byte*>(memory.mapped) + items.offset + stride * i,
                  each * sizeof(T));
    }
    return values;
  }
  [[nodiscard]] std::vector<float> places(std::size_t n) const {
    return read<float>(surface.places, vertices_, n, 3);
  }
  [[nodiscard]] std::vector<float> normals(std::size_t n) const {
    return read<float>(surface.normals, vertices_, n, 3);
  }
  [[nodiscard]] std::vector<std::int32_t> triangles(std::size_t n) const {
    return read<std::int32_t>(surface.triangles, triangles_, n, 3);
  }
  [[nodiscard]] std::vector<std::int32_t> facts(std::size_t n) const {
    return read<std::int32_t>(surface.facts, facts_, n, 3);
  }
  [[nodiscard]] std::vector<float> values(std::size_t n) const {
    return read<float>(surface.values, values_, n, 4);
  }
  [[nodiscard]] std::vector<float> skin(std::size_t n) const {
    return read<float>(surface.skin, skin_, n, 3);
  }
  [[nodiscard]] std::vector<std::uint32_t> lives(std::size_t n) const {
    return read<std::uint32_t>(surface.skin_lives, lives_, n, 1);
  }
  /// Bytes of triangles that are not as allocate() and forget() fill them, by triangle.
  [[nodiscard]] std::vector<std::size_t> written() const {
    std::vector<std::size_t> list;
    const auto all = triangles(surface.triangles.size / 12);
    for (std::size_t t = 0; 3 * t < all.size(); ++t) {
      if (all[3 * t] != kFilled) list.push_back(t);
    }
    return list;
  }
  void forget() const {
    std::memset(triangles_.mapped, 0xa5, triangles_.size);
    std::memset(facts_.mapped, 0xa5, facts_.size);
  }
  void expect_nothing_beside() const {
    const auto untouched = [](std::byte b) { return b == std::byte{0xa5}; };
    for (const auto& memory : {vertices_, triangles_, facts_, skin_, lives_, values_}) {
      const auto* bytes = static_cast<const std::byte*>(memory.mapped);
      EXPECT_TRUE(std::all_of(bytes, bytes + kBefore, untouched));
      EXPECT_TRUE(std::all_of(bytes + memory.size - kAfter, bytes + memory.size, untouched));
    }
    const auto* between = static_cast<const std::byte*>(values_.mapped) + kBefore;
    for (std::uint64_t at = 16; at < surface.values.size; at += kValues) {
      EXPECT_TRUE(std::all_of(between + at, between + at + 4, untouched));
    }
    const auto* first = static_cast<const std::byte*>(vertices_.mapped) + kBefore;
    for (std::uint64_t at = 0; at + kVertex <= vertices_.size - kBefore - kAfter; at += kVertex) {
      for (std::uint64_t gap : {at + 12, at + kNormalAt + 12}) {
        EXPECT_TRUE(std::all_of(first + gap, first + gap + 4, untouched));
      }
    }
  }

  sunder_vulkan_surface surface = SUNDER_VULKAN_SURFACE_INIT;

 private:
  static constexpr std::uint64_t kBefore = 36, kAfter = 64;  // bytes
  static constexpr std::int32_t kFilled = static_cast<std::int32_t>(0xa5a5a5a5);
  static constexpr VkBufferUsageFlags kUsage =
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT;
  [[nodiscard]] static sunder_vulkan_items items(const VulkanHost::Memory& memory, std::uint64_t at,
                                                 std::uint64_t size) {
    return {reinterpret_cast<std::uint64_t>(memory.buffer), kBefore + at, size, kUsage, 0};
  }
  const VulkanHost& host_;
  VulkanHost::Memory vertices_, triangles_, facts_, skin_, lives_, values_;
};

}  // namespace sunder::test
