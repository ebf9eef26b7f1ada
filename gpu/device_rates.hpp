// SPDX-License-Identifier: Apache-2.0
// What a device does in a second: measured once when somebody asks for it, and kept by device and
// driver in a file of its own, so that every later plan predicts the same.
#pragma once

#include <filesystem>
#include <optional>

#include "gpu/kernels.hpp"

namespace sunder::gpu {

struct DeviceRates {
  double submit = 0;    ///< [s] of a submit with its fence
  double dispatch = 0;  ///< [s] of a dispatch with its barrier
  double bytes = 0;     ///< a second, read from memory by kernels
  double flops = 0;     ///< a second, in fp64 (fp32 on a device without); a multiply-add is two
};

/// Of an idle device in under a second; the least of some runs each. Throws DeviceLost.
[[nodiscard]] DeviceRates measure_rates(vulkan::Device& device, Variant variant);

/// Where they are kept: in SUNDER_CACHE_DIR, else sunder/ of the user's folder for such files
/// (XDG_CACHE_HOME, HOME/.cache, LOCALAPPDATA). Nothing: there is none, or SUNDER_CACHE_DIR is
/// empty.
[[nodiscard]] std::optional<std::filesystem::path> rates_file(const vulkan::PhysicalDevice& device);

/// What this process has measured of a device, else what the file keeps; nothing: neither has it,
/// or the file is not in the form in which it was written.
[[nodiscard]] std::optional<DeviceRates> kept_rates(const vulkan::PhysicalDevice& device);

/// For this process, and in the file; false: that could not be written.
bool keep_rates(const vulkan::PhysicalDevice& device, const DeviceRates& rates);

}  // namespace sunder::gpu
