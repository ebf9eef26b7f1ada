// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace sunder::machine {

/// Bytes that can be had without swapping: free ones and what caches files, within what a container
/// is allowed.
[[nodiscard]] std::size_t available_memory();

}  // namespace sunder::machine
