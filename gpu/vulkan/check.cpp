// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/check.hpp"

#include <string>

namespace sunder::vulkan {

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  const std::string call = what;
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      throw DeviceLost("the Vulkan device was lost in " + call +
                       " (driver reset, unplugged or hung); what it held is gone");
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      throw DeviceError("the Vulkan device is out of memory in " + call +
                        "; use a smaller mesh, precision fp32, route cg or backend cpu");
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      throw DeviceError("the Vulkan driver is out of main memory in " + call +
                        "; use a smaller mesh or route cg");
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      throw DeviceError("no Vulkan driver was found (" + call +
                        "); install one (mesa-vulkan-drivers, say) or use backend cpu");
    case VK_ERROR_LAYER_NOT_PRESENT:
      throw DeviceError("the Vulkan validation layer is not installed (" + call +
                        "); install vulkan-validationlayers or turn validation off");
    default:
      throw DeviceError(call + " failed with the Vulkan result " + std::to_string(result));
  }
}

}  // namespace sunder::vulkan
