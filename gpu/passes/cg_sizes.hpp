// SPDX-License-Identifier: Apache-2.0
// The sizes of an iteration's dispatches, which the device writes: three words for each of the
// kCgSizes kinds (shaders/layout.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/layout.h"

namespace sunder::gpu {

constexpr std::size_t kCgSizeWords = 3 * shaders::kCgSizes;

/// Where a kind's begins, in bytes.
[[nodiscard]] constexpr std::size_t size_of_dispatch(std::uint32_t kind) {
  return 3 * kind * sizeof(std::uint32_t);
}

}  // namespace sunder::gpu
