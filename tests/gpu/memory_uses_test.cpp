// SPDX-License-Identifier: Apache-2.0
// What kernels do with their buffers, and which commands must wait for which.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <tuple>

#include "gpu/vulkan/memory_uses.hpp"
#include "gpu/vulkan/shader_uses.hpp"
#include "shaders/embedded.hpp"

namespace sunder::test {
namespace {

using vulkan::MemoryUse;
using vulkan::MemoryUses;
using vulkan::Use;

constexpr Use kReads{.reads = true}, kWrites{.writes = true}, kBoth{.reads = true, .writes = true};

/// Of one buffer; a number stands for Vulkan's handle.
MemoryUse part(std::size_t begin, std::size_t end, Use use, const void* kernel = nullptr) {
  return {reinterpret_cast<VkBuffer>(std::uintptr_t{16}), begin, end, use, kernel};
}

bool waits(const MemoryUse& next, const MemoryUse& before, bool apart = false) {
  MemoryUses uses;
  uses.add({&before, 1});
  return uses.conflict({&next, 1}, apart);
}

TEST(MemoryUses, WhoReadsWaitsForWritersWhoWritesForAll) {
  for (const auto& [before, next, expected] :
       {std::tuple(kReads, kReads, false), std::tuple(kReads, kWrites, true),
        std::tuple(kWrites, kReads, true), std::tuple(kWrites, kWrites, true),
        std::tuple(kBoth, kBoth, true)}) {
    EXPECT_EQ(waits(part(0, 8, next), part(0, 8, before)), expected);
  }
}

TEST(MemoryUses, OtherBytesAndOtherBuffersDoNotCount) {
  EXPECT_FALSE(waits(part(8, 16, kBoth), part(0, 8, kBoth)));
  EXPECT_TRUE(waits(part(7, 16, kBoth), part(0, 8, kBoth)));
  EXPECT_TRUE(waits(part(0, 1, kBoth), part(0, 8, kBoth)));
  MemoryUse other = part(0, 8, kBoth);
  other.buffer = reinterpret_cast<VkBuffer>(std::uintptr_t{32});
  EXPECT_FALSE(waits(other, part(0, 8, kBoth)));
}

TEST(MemoryUses, ApartIsSaidOfOneKernelAlone) {
  const int a = 0, b = 0;
  EXPECT_TRUE(waits(part(0, 8, kWrites, &a), part(0, 8, kWrites, &a)));
  EXPECT_FALSE(waits(part(0, 8, kWrites, &a), part(0, 8, kWrites, &a), true));
  EXPECT_TRUE(waits(part(0, 8, kWrites, &a), part(0, 8, kWrites, &b), true));
}

TEST(MemoryUses, ABarrierForgets) {
  MemoryUses uses;
  const MemoryUse all = part(0, 8, kBoth);
  uses.add({&all, 1});
  uses.clear();
  EXPECT_FALSE(uses.conflict({&all, 1}));
}

TEST(ShaderUses, AreThoseOfTheSource) {
  for (const char* variant : {"gpu", "lvp"}) {  // shaders/add.comp: u += du
    const auto add = vulkan::shader_uses(shaders::find(std::string("add_") + variant + "_fp64"));
    ASSERT_EQ(add.size(), 2u);
    EXPECT_TRUE(add[0].reads);
    EXPECT_FALSE(add[0].writes);
    EXPECT_TRUE(add[1].reads);
    EXPECT_TRUE(add[1].writes);
  }
  // shaders/gather.comp reads places and values and writes what it picks.
  const auto gather = vulkan::shader_uses(shaders::find("gather_gpu_fp64"));
  ASSERT_EQ(gather.size(), 3u);
  for (const std::size_t source : {0u, 1u}) {
    EXPECT_TRUE(gather[source].reads);
    EXPECT_FALSE(gather[source].writes);
  }
  EXPECT_FALSE(gather[2].reads);
  EXPECT_TRUE(gather[2].writes);
}

TEST(ShaderUses, EveryBindingOfEveryKernelHasOne) {
  ASSERT_FALSE(shaders::names().empty());
  for (std::string_view name : shaders::names()) {
    SCOPED_TRACE(name);
    bool writes = false;
    for (const Use& use : vulkan::shader_uses(shaders::find(name))) {
      EXPECT_TRUE(use.reads || use.writes);
      writes |= use.writes;
    }
    EXPECT_TRUE(writes);
  }
}

TEST(ShaderUses, OfNothingAreNone) {
  EXPECT_TRUE(vulkan::shader_uses({}).empty());
  const std::uint32_t cut[] = {0x07230203, 0x10000, 0, 8, 0, 0xffff003d, 1};  // an endless load
  EXPECT_TRUE(vulkan::shader_uses(cut).empty());
}

}  // namespace
}  // namespace sunder::test
