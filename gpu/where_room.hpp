// SPDX-License-Identifier: Apache-2.0
// What a device has where there is room for it: the host does the same otherwise.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "gpu/vulkan/device.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {

/// Takes what a backend leaves out, in words; empty: nobody listens.
using LeaveOut = std::function<void(std::string)>;

/// A T from these arguments, of `bytes()` bytes, where those leave a share of the device's memory
/// free. Null where the device, or others who have it, leave no memory for that: `leave_out` is
/// told what is done `instead`, in words. Throws DeviceLost.
template <class T, class Bytes, class... Arguments>
[[nodiscard]] std::unique_ptr<T> where_room(const vulkan::Device& device, double free,
                                            const Bytes& bytes, const char* instead,
                                            const LeaveOut& leave_out,
                                            const Arguments&... arguments) {
  try {
    if (static_cast<double>(device.held_bytes() + bytes()) <=
        (1 - free) * static_cast<double>(device.physical().memory)) {
      return std::make_unique<T>(arguments...);
    }
  } catch (const DeviceLost&) {
    throw;
  } catch (const DeviceError&) {  // others have the memory, or a buffer is too large
  }
  if (leave_out) leave_out(instead);
  return nullptr;
}

}  // namespace sunder::gpu
