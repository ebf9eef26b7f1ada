// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/shader_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

namespace sunder::vulkan {
namespace {

// SPIR-V specification, 3.32 "Instructions" and 3.7 "Storage Class".
enum MemoryOp : std::uint32_t {
  kTypeInt = 21,
  kTypeFloat = 22,
  kTypeVector = 23,
  kTypeArray = 28,
  kTypeStruct = 30,
  kTypePointer = 32,
  kConstant = 43,
  kVariable = 59,
};
constexpr std::uint32_t kWorkgroup = 4;
constexpr std::size_t kHeaderWords = 5;

struct Layout {
  std::uint64_t bytes = 0, alignment = 1;
};

std::uint64_t aligned(std::uint64_t at, std::uint64_t alignment) {
  return (at + alignment - 1) / alignment * alignment;
}

class SharedVariables {
 public:
  std::uint64_t bytes = 0;

  void read(std::span<const std::uint32_t> op, std::uint32_t code) {
    if (code == kTypeInt || code == kTypeFloat) {
      types_[op[1]] = {op[2] / 8, op[2] / 8};
    } else if (code == kTypeVector) {
      const Layout of = types_[op[2]];
      types_[op[1]] = {op[3] * of.bytes, (op[3] == 2 ? 2 : 4) * of.bytes};
    } else if (code == kTypeArray) {
      const Layout of = types_[op[2]];
      types_[op[1]] = {constants_[op[3]] * aligned(of.bytes, of.alignment), of.alignment};
    } else if (code == kTypeStruct) {
      types_[op[1]] = members(op.subspan(2));
    } else if (code == kTypePointer && op[2] == kWorkgroup) {
      shared_[op[1]] = types_[op[3]];
    } else if (code == kConstant) {
      constants_[op[2]] = op[3];
    } else if (code == kVariable && op[3] == kWorkgroup) {
      const Layout of = shared_[op[1]];
      bytes = aligned(bytes, of.alignment) + of.bytes;
    }
  }

 private:
  Layout members(std::span<const std::uint32_t> types) {
    Layout all;
    for (const std::uint32_t type : types) {
      const Layout of = types_[type];
      all.bytes = aligned(all.bytes, of.alignment) + of.bytes;
      all.alignment = std::max(all.alignment, of.alignment);
    }
    all.bytes = aligned(all.bytes, all.alignment);
    return all;
  }

  std::map<std::uint32_t, Layout> types_, shared_;  // shared_: what a pointer type points to
  std::map<std::uint32_t, std::uint64_t> constants_;
};

}  // namespace

std::uint64_t shared_bytes(std::span<const std::uint32_t> spirv) {
  SharedVariables variables;
  for (std::size_t at = kHeaderWords; at < spirv.size();) {
    const std::uint32_t words = spirv[at] >> 16;
    if (words == 0 || at + words > spirv.size()) break;
    variables.read(spirv.subspan(at, words), spirv[at] & 0xffff);
    at += words;
  }
  return variables.bytes;
}

}  // namespace sunder::vulkan
