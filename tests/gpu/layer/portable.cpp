// SPDX-License-Identifier: Apache-2.0
// A device as MoltenVK's: who does not ask for VK_KHR_portability_subset gets none.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "layer.hpp"

namespace sunder::layer {
namespace {

constexpr const char* kSubset = "VK_KHR_portability_subset";

VKAPI_ATTR VkResult VKAPI_CALL list_extensions(VkPhysicalDevice physical, const char* layer,
                                               std::uint32_t* count, VkExtensionProperties* list) {
  const auto next = next_of_instance<PFN_vkEnumerateDeviceExtensionProperties>(
      physical, "vkEnumerateDeviceExtensionProperties");
  if (layer) return next(physical, layer, count, list);
  std::uint32_t there = 0;
  if (const VkResult result = next(physical, nullptr, &there, nullptr)) return result;
  if (!list) {
    *count = there + 1;
    return VK_SUCCESS;
  }
  std::vector<VkExtensionProperties> all(there);
  if (const VkResult result = next(physical, nullptr, &there, all.data())) return result;
  VkExtensionProperties& ours = all.emplace_back();
  std::strncpy(ours.extensionName, kSubset, sizeof ours.extensionName - 1);
  ours.specVersion = 1;
  const std::size_t taken = std::min<std::size_t>(*count, all.size());
  std::copy_n(all.begin(), taken, list);
  *count = static_cast<std::uint32_t>(taken);
  return taken < all.size() ? VK_INCOMPLETE : VK_SUCCESS;
}

}  // namespace

VkResult ask_for_portability(DeviceWish& wish) {
  const auto asked = [](const char* name) { return std::string_view(name) == kSubset; };
  if (std::erase_if(wish.extensions, asked) == 1) {
    tell("VK_KHR_portability_subset was asked for");
    return VK_SUCCESS;
  }
  blame("a device of a portable subset was made without VK_KHR_portability_subset");
  return VK_ERROR_INITIALIZATION_FAILED;
}

PFN_vkVoidFunction portable(const char* name) {
  if (std::strcmp(name, "vkEnumerateDeviceExtensionProperties") != 0) return nullptr;
  return as_void(&list_extensions);
}

}  // namespace sunder::layer
