// SPDX-License-Identifier: Apache-2.0
// Races in the memory that a workgroup shares, which lavapipe never shows: it runs subgroups one
// after the other. Every compiled kernel is walked through as one invocation runs it, functions
// where they are called and loops twice: between a value's writing and its reading there is a
// barrier, and between its reading and the next writing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "gpu/vulkan/shader_memory.hpp"
#include "shaders/embedded.hpp"

namespace sunder::test {
namespace {

// SPIR-V specification, 3.32 "Instructions".
enum WalkedOp : std::uint32_t {
  kOpEntryPoint = 15,
  kOpFunction = 54,
  kOpFunctionEnd = 56,
  kOpFunctionCall = 57,
  kOpVariable = 59,
  kOpLoad = 61,
  kOpStore = 62,
  kOpAccessChain = 65,
  kOpInBoundsAccessChain = 66,
  kOpControlBarrier = 224,
  kOpLoopMerge = 246,
  kOpLabel = 248,
};
constexpr std::uint32_t kWorkgroupClass = 4, kNop = 0x10000;

class SharedWalk {
 public:
  explicit SharedWalk(std::span<const std::uint32_t> words) {
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
      ops_.push_back(words.subspan(at, words[at] >> 16));
      note(ops_.size() - 1);
    }
    const auto [begin, end] = functions_.at(main_);
    walk(begin, end);
  }
  /// Variables that are read or written too early.
  [[nodiscard]] std::size_t races() const { return races_.size(); }

 private:
  static std::uint32_t code(std::span<const std::uint32_t> op) { return op[0] & 0xffff; }

  /// Where things are.
  void note(std::size_t i) {
    const auto op = ops_[i];
    switch (code(op)) {
      case kOpEntryPoint:
        main_ = op[2];
        break;
      case kOpFunction:
        open_ = op[2];
        functions_[open_].first = i + 1;
        break;
      case kOpFunctionEnd:
        functions_[open_].second = i;
        break;
      case kOpLabel:
        labels_[op[1]] = i;
        break;
      case kOpVariable:
        if (op[3] == kWorkgroupClass) shared_[op[2]] = op[2];
        break;
      case kOpAccessChain:
      case kOpInBoundsAccessChain:
        if (const auto of = shared_.find(op[3]); of != shared_.end()) shared_[op[2]] = of->second;
        break;
      default:
        break;
    }
  }

  void walk(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto op = ops_[i];
      switch (code(op)) {
        case kOpLoopMerge: {
          const std::size_t after = labels_.at(op[1]);
          walk(i + 1, after);
          walk(i + 1, after);
          i = after;
          break;
        }
        case kOpFunctionCall: {
          const auto [first, last] = functions_.at(op[3]);
          walk(first, last);
          break;
        }
        case kOpControlBarrier:
          read_.clear();
          written_.clear();
          break;
        case kOpLoad:
          touch(op[3], read_, written_);
          break;
        case kOpStore:
          touch(op[1], written_, read_);
          break;
        default:
          break;
      }
    }
  }
  void touch(std::uint32_t pointer, std::set<std::uint32_t>& this_way,
             const std::set<std::uint32_t>& other_way) {
    const auto of = shared_.find(pointer);
    if (of == shared_.end()) return;
    if (other_way.contains(of->second)) races_.insert(of->second);
    this_way.insert(of->second);
  }

  std::vector<std::span<const std::uint32_t>> ops_;
  std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> functions_;
  std::map<std::uint32_t, std::size_t> labels_;
  std::map<std::uint32_t, std::uint32_t> shared_;  // of a pointer: the variable that it leads into
  std::uint32_t main_ = 0, open_ = 0;
  std::set<std::uint32_t> read_, written_, races_;  // since the last barrier
};

TEST(SharedMemoryRaces, AreInNoKernel) {
  int sharing = 0;
  for (std::string_view name : shaders::names()) {
    EXPECT_EQ(SharedWalk(shaders::find(name)).races(), 0u) << name;
    sharing += vulkan::shared_bytes(shaders::find(name)) > 0;
  }
  EXPECT_GT(sharing, 10);
}

/// The kernel with its n-th barrier taken out; empty: it has no more.
std::vector<std::uint32_t> without_barrier(std::string_view name, int n) {
  const auto words = shaders::find(name);
  std::vector<std::uint32_t> changed(words.begin(), words.end());
  for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
    if ((words[at] & 0xffff) != kOpControlBarrier || n-- > 0) continue;
    std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(at), words[at] >> 16, kNop);
    return changed;
  }
  return {};
}

// Two sums, one after the other (shaders/part_sum.glsl): the barrier before a sum keeps it from the
// one before, that in its middle from itself. And a product and a summary, with one each.
TEST(SharedMemoryRaces, AreSeenWhereABarrierIsMissing) {
  for (const auto& [name, barriers] :
       {std::pair{"cg_length_gpu_fp64", 2}, std::pair{"dense_gpu_fp64", 1},
        std::pair{"summary_gpu_fp64", 1}}) {
    for (int n = 0; n < barriers; ++n) {
      const auto changed = without_barrier(name, n);
      ASSERT_FALSE(changed.empty()) << name;
      EXPECT_GT(SharedWalk(changed).races(), 0u) << name << ", barrier " << n;
    }
    EXPECT_TRUE(without_barrier(name, barriers).empty()) << name;
  }
}

}  // namespace
}  // namespace sunder::test
