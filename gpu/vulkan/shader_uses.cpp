// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/shader_uses.hpp"

#include <cstddef>
#include <map>

namespace sunder::vulkan {
namespace {

// SPIR-V specification, 3.32 "Instructions" and 3.20 "Decoration".
enum Op : std::uint32_t {
  kFunctionCall = 57,
  kLoad = 61,
  kStore = 62,
  kCopyMemory = 63,
  kAccessChain = 65,
  kInBoundsAccessChain = 66,
  kDecorate = 71,
  kFirstAtomic = 227,  // OpAtomicLoad
  kAtomicStore = 228,
  kLastAtomic = 242,  // OpAtomicXor
};
constexpr std::uint32_t kBinding = 33;
constexpr std::size_t kHeader = 5;  // words

class Module {
 public:
  std::vector<Use> uses;

  void read(std::span<const std::uint32_t> op, std::uint32_t code) {
    if (code == kDecorate && op.size() > 3 && op[2] == kBinding) {
      root_[op[1]] = op[3];
      if (uses.size() <= op[3]) uses.resize(op[3] + 1);
    } else if (code == kAccessChain || code == kInBoundsAccessChain) {
      if (const auto at = root_.find(op[3]); at != root_.end()) root_[op[2]] = at->second;
    } else if (code == kLoad) {
      note(op[3], {.reads = true});
    } else if (code == kStore) {
      note(op[1], {.writes = true});
    } else if (code == kFunctionCall) {
      for (const std::uint32_t argument : op.subspan(4)) note(argument, {.reads = true});
    } else if (code == kCopyMemory) {
      note(op[1], {.writes = true});
      note(op[2], {.reads = true});
    } else if (code == kAtomicStore) {
      note(op[1], {.writes = true});
    } else if (code >= kFirstAtomic && code <= kLastAtomic) {
      note(op[3], {.reads = true, .writes = code != kFirstAtomic});
    }
  }

 private:
  void note(std::uint32_t pointer, Use use) {
    const auto at = root_.find(pointer);
    if (at == root_.end()) return;  // of the kernel's own
    uses[at->second].reads |= use.reads;
    uses[at->second].writes |= use.writes;
  }

  std::map<std::uint32_t, std::uint32_t> root_;  // of a pointer: the binding that it leads into
};

}  // namespace

std::vector<Use> shader_uses(std::span<const std::uint32_t> spirv) {
  Module module;
  for (std::size_t at = kHeader; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16;
    if (words == 0 || at + words > spirv.size()) break;
    module.read(spirv.subspan(at, words), spirv[at] & 0xffff);
    at += words;
  }
  return module.uses;
}

}  // namespace sunder::vulkan
