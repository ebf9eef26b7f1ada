// SPDX-License-Identifier: Apache-2.0
// Which Vulkan device a scene gets, and the list that `sunder devices` shows.
#include <algorithm>
#include <exception>
#include <iomanip>
#include <locale>
#include <sstream>

#include "gpu/choose_device.hpp"
#include "gpu/device_rates.hpp"
#include "gpu/vulkan_backend.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

/// The first GPU that can run the kernels, discrete ones first; -1: none.
int first_gpu(const std::vector<vulkan::PhysicalDevice>& list) {
  for (const bool discrete : {true, false}) {
    for (std::size_t d = 0; d < list.size(); ++d) {
      const bool fits = !list[d].is_cpu() && list[d].shortcoming().empty();
      const bool is_discrete = list[d].type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
      if (fits && is_discrete == discrete) return static_cast<int>(d);
    }
  }
  return -1;
}

constexpr const char* kNoDevice =
    "no Vulkan driver with a device was found; install one (mesa-vulkan-drivers, say) or use "
    "backend cpu";

std::vector<vulkan::PhysicalDevice> list_devices(const vulkan::Instance& instance,
                                                 const vulkan::DeviceProbe& probe) {
  auto list = vulkan::list_devices(instance);
  for (auto& device : list) device = vulkan::probed(std::move(device), probe);
  return list;
}

std::string megabytes(VkDeviceSize bytes) { return std::to_string(bytes / 1000000) + " MB"; }

std::string in_words(const DeviceRates& rates) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(3) << 1e6 * rates.submit << " us a submit, " << 1e6 * rates.dispatch
       << " us a dispatch, " << 1e-9 * rates.bytes << " GB/s, " << 1e-9 * rates.flops << " GFLOP/s";
  return text.str();
}

DeviceInfo describe(const vulkan::PhysicalDevice& device, int index, int chosen) {
  DeviceInfo info;
  info.backend = "vulkan";
  info.index = index;
  info.name = device.name;
  info.driver = device.driver;
  const std::string shortcoming = device.shortcoming();
  info.precisions = !shortcoming.empty() ? "none" : device.float64 ? "fp32 fp64" : "fp32";
  info.limits =
      megabytes(device.memory) + " memory, buffers up to " +
      megabytes(device.limits.buffer_bytes.value) + ", subgroups of " +
      std::to_string(device.subgroup) +
      (device.float64 ? ", routes inverse, condensed, cg" : ", routes inverse, condensed");
  if (const auto rates = kept_rates(device)) info.rates = in_words(*rates);
  info.chosen = index == chosen;
  if (!shortcoming.empty()) {
    info.why = "cannot be used: " + shortcoming;
  } else if (device.is_cpu()) {
    info.why = "runs on the processor, where backend cpu is quicker; only by name";
  } else if (info.chosen) {
    info.why = "first GPU";
  } else {
    info.why = "another GPU comes first; choose it with device = " + std::to_string(index);
  }
  return info;
}

}  // namespace

vulkan::PhysicalDevice choose_device(const vulkan::Instance& instance, int asked,
                                     const vulkan::DeviceProbe& probe) {
  const auto list = list_devices(instance, probe);
  if (list.empty()) throw DeviceError(kNoDevice);
  if (asked >= static_cast<int>(list.size())) {
    throw DeviceError("there is no Vulkan device " + std::to_string(asked) + "; devices 0 to " +
                      std::to_string(list.size() - 1) + " exist");
  }
  if (asked >= 0) return list[static_cast<std::size_t>(asked)];
  const int gpu = first_gpu(list);
  if (gpu >= 0) return list[static_cast<std::size_t>(gpu)];
  const auto fits =
      std::find_if(list.begin(), list.end(), [](const auto& d) { return d.shortcoming().empty(); });
  return fits == list.end() ? list.front() : *fits;
}

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> infos;
  std::vector<vulkan::PhysicalDevice> list;
  const VulkanOptions options = options_from_environment();
  try {
    list = list_devices(vulkan::Instance(options.instance), options.probe);
  } catch (const DeviceError&) {
    return infos;  // no loader or no driver: there are no Vulkan devices
  }
  const int chosen = first_gpu(list);
  for (std::size_t d = 0; d < list.size(); ++d) {
    infos.push_back(describe(list[d], static_cast<int>(d), chosen));
  }
  return infos;
}

std::vector<std::string> measure_devices(bool again) {
  std::vector<std::string> missing;
  const VulkanOptions options = options_from_environment();
  std::shared_ptr<vulkan::Instance> instance;
  std::vector<vulkan::PhysicalDevice> list;
  try {
    instance = std::make_shared<vulkan::Instance>(options.instance);
    list = list_devices(*instance, options.probe);
  } catch (const DeviceError&) {
    return missing;  // as devices()
  }
  for (const auto& device : list) {
    if (!device.shortcoming().empty() || (!again && kept_rates(device))) continue;
    try {
      const auto own = vulkan::create_device(instance, device, options.probe, {});
      const bool kept = keep_rates(device, measure_rates(*own, choose_variant(device)));
      if (const auto file = rates_file(device); !kept && file) {
        missing.push_back("what the device \"" + device.name +
                          "\" does in a second cannot be kept in " + file->string() +
                          "; let SUNDER_CACHE_DIR be a folder that can be written");
      }
    } catch (const std::exception& error) {
      missing.push_back("the device \"" + device.name + "\" cannot be measured: " + error.what());
    }
  }
  return missing;
}

std::optional<std::string> missing_gpu() {
  std::vector<vulkan::PhysicalDevice> list;
  const VulkanOptions options = options_from_environment();
  try {
    list = list_devices(vulkan::Instance(options.instance), options.probe);
  } catch (const DeviceError& error) {
    return error.what();
  }
  if (first_gpu(list) >= 0) return std::nullopt;
  if (list.empty()) return kNoDevice;
  for (const auto& device : list) {
    if (device.is_cpu()) continue;
    return "the Vulkan device \"" + device.name + "\" cannot be used: " + device.shortcoming() +
           "; update its driver or use backend cpu";
  }
  return "";
}

}  // namespace sunder::gpu
