// SPDX-License-Identifier: Apache-2.0
#include "app/view/vulkan/device.hpp"

#include <dlfcn.h>

#include "sunder/error.hpp"

namespace sunder::app::view {
namespace {

constexpr const char* kLoader = "libvulkan.so.1";

template <class Function, class Get, class Handle>
void load(Function& function, Get get, Handle handle, const char* name) {
  function = reinterpret_cast<Function>(get(handle, name));
  if (!function) throw DeviceError(std::string("the Vulkan driver lacks the function ") + name);
}

bool is_gpu(const VkPhysicalDeviceProperties& properties) {
  return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
         properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ||
         properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU;
}

}  // namespace

void check(VkResult result, const char* call) {
  if (result == VK_SUCCESS) return;
  const std::string what = result == VK_ERROR_DEVICE_LOST            ? "the device was lost"
                           : result == VK_ERROR_OUT_OF_DEVICE_MEMORY ? "out of device memory"
                           : result == VK_ERROR_OUT_OF_HOST_MEMORY   ? "out of memory"
                                                                     : "error";
  const std::string sentence =
      "drawing failed in " + std::string(call) + ": " + what + " (" + std::to_string(result) + ")";
  if (result == VK_ERROR_DEVICE_LOST) throw DeviceLost(sentence);
  throw DeviceError(sentence);
}

Device::Device(const DeviceOptions& options) : probe_(options.probe) {
  try {
    open_loader();
    create_instance(options);
    if (options.with_instance) options.with_instance(instance_, get_);
    choose(options);
    create_device(options);
  } catch (...) {
    close();
    throw;
  }
}

Device::~Device() { close(); }

void Device::close() noexcept {
  if (device_) {
    vk_.DeviceWaitIdle(device_);
    vk_.DestroyDevice(device_, nullptr);
  }
  if (instance_) of_instance_.DestroyInstance(instance_, nullptr);
  if (library_) dlclose(library_);
}

void Device::open_loader() {
  library_ = dlopen(kLoader, RTLD_NOW | RTLD_LOCAL);
  if (library_) {
    get_ = reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(library_, "vkGetInstanceProcAddr"));
  }
  if (!get_) {
    throw DeviceError(std::string("there is nothing to draw with: no Vulkan loader (") + kLoader +
                      "); install libvulkan1 and a driver, mesa-vulkan-drivers say");
  }
}

void Device::create_instance(const DeviceOptions& options) {
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.pApplicationName = "sunder view";
  application.apiVersion = VK_API_VERSION_1_2;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &application;
  info.enabledExtensionCount = static_cast<std::uint32_t>(options.instance_extensions.size());
  info.ppEnabledExtensionNames = options.instance_extensions.data();
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(get_(nullptr, "vkCreateInstance"));
  check(create(&info, nullptr, &instance_), "vkCreateInstance");
#define SUNDER_VIEW_LOAD(name) load(of_instance_.name, get_, instance_, "vk" #name);
  SUNDER_VIEW_INSTANCE_FUNCTIONS(SUNDER_VIEW_LOAD)
#undef SUNDER_VIEW_LOAD
}

void Device::choose(const DeviceOptions& options) {
  std::uint32_t count = 0;
  const VkResult listed = of_instance_.EnumeratePhysicalDevices(instance_, &count, nullptr);
  if (listed != VK_ERROR_INITIALIZATION_FAILED) check(listed, "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> devices(count);
  if (count > 0) {
    check(of_instance_.EnumeratePhysicalDevices(instance_, &count, devices.data()),
          "vkEnumeratePhysicalDevices");
  }
  if (options.index != kNone && static_cast<std::size_t>(options.index) >= devices.size()) {
    throw DeviceError("there is no Vulkan device " + std::to_string(options.index) +
                      " to draw with; `sunder devices` lists them");
  }
  bool found_gpu = false;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    if (options.index != kNone && d != static_cast<std::size_t>(options.index)) continue;
    VkPhysicalDeviceProperties properties{};
    of_instance_.GetPhysicalDeviceProperties(devices[d], &properties);
    if (properties.apiVersion < VK_API_VERSION_1_2) continue;
    const bool gpu = is_gpu(properties);
    if (physical_ && (found_gpu || !gpu)) continue;
    std::uint32_t families = 0;
    of_instance_.GetPhysicalDeviceQueueFamilyProperties(devices[d], &families, nullptr);
    std::vector<VkQueueFamilyProperties> list(families);
    of_instance_.GetPhysicalDeviceQueueFamilyProperties(devices[d], &families, list.data());
    for (std::uint32_t f = 0; f < families; ++f) {
      constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
      if ((list[f].queueFlags & kNeeded) != kNeeded) continue;
      if (options.presents && !options.presents(devices[d], f)) continue;
      physical_ = devices[d];
      family_ = f;
      name_ = properties.deviceName;
      found_gpu = gpu;
      break;
    }
  }
  if (!physical_) {
    throw DeviceError(
        "there is no Vulkan device that draws; `sunder devices` lists what is there, and "
        "mesa-vulkan-drivers brings one that runs on the processor");
  }
  of_instance_.GetPhysicalDeviceMemoryProperties(physical_, &memory_);
}

void Device::create_device(const DeviceOptions& options) {
  VkPhysicalDeviceVulkan12Features offered12{};
  offered12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  VkPhysicalDeviceFeatures2 offered{};
  offered.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  offered.pNext = &offered12;
  of_instance_.GetPhysicalDeviceFeatures2(physical_, &offered);
  // For a simulation on the same device.
  VkPhysicalDeviceVulkan12Features enabled12{};
  enabled12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  enabled12.timelineSemaphore = offered12.timelineSemaphore;
  VkPhysicalDeviceFeatures enabled{};
  enabled.shaderFloat64 = offered.features.shaderFloat64;
  enabled.shaderInt64 = offered.features.shaderInt64;
  features_ = 0;
  if (enabled.shaderFloat64) features_ |= SUNDER_VULKAN_SHADER_FLOAT64;
  if (enabled.shaderInt64) features_ |= SUNDER_VULKAN_SHADER_INT64;
  if (enabled12.timelineSemaphore) features_ |= SUNDER_VULKAN_TIMELINE_SEMAPHORE;
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.pNext = &enabled12;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(options.device_extensions.size());
  info.ppEnabledExtensionNames = options.device_extensions.data();
  info.pEnabledFeatures = &enabled;
  VkDevice device = VK_NULL_HANDLE;
  check(of_instance_.CreateDevice(physical_, &info, nullptr, &device), "vkCreateDevice");
  const PFN_vkGetDeviceProcAddr get = of_instance_.GetDeviceProcAddr;
#define SUNDER_VIEW_LOAD(name) load(vk_.name, get, device, "vk" #name);
  SUNDER_VIEW_DEVICE_FUNCTIONS(SUNDER_VIEW_LOAD)
#undef SUNDER_VIEW_LOAD
  device_ = device;
  vk_.GetDeviceQueue(device_, family_, 0, &queue_);
}

std::uint32_t Device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags needed,
                                  VkMemoryPropertyFlags wanted) const {
  for (const VkMemoryPropertyFlags all : {needed | wanted, needed}) {
    for (std::uint32_t t = 0; t < memory_.memoryTypeCount; ++t) {
      if ((allowed >> t & 1U) && (memory_.memoryTypes[t].propertyFlags & all) == all) return t;
    }
  }
  throw DeviceError("device " + name_ + " has no memory of a kind that drawing takes");
}

void Device::submit(const VkSubmitInfo& info, VkFence done) {
  const std::lock_guard lock(lock_);
  std::error_code ignored;
  if (probe_.submits == 0 ||
      (!probe_.submit_file.empty() && std::filesystem::remove(probe_.submit_file, ignored))) {
    check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit");
  }
  if (probe_.submits > 0) --probe_.submits;
  check(vk_.QueueSubmit(queue_, 1, &info, done), "vkQueueSubmit");
}

void Device::wait_idle() {
  const std::lock_guard lock(lock_);
  vk_.DeviceWaitIdle(device_);  // a lost one is told where it is used next
}

VkResult Device::present(PFN_vkQueuePresentKHR by, const VkPresentInfoKHR& info) {
  const std::lock_guard lock(lock_);
  std::error_code ignored;
  if (!probe_.present_file.empty() && std::filesystem::remove(probe_.present_file, ignored)) {
    return VK_ERROR_DEVICE_LOST;
  }
  return by(queue_, &info);
}

Devices::Devices(DeviceOptions options) : options_(std::move(options)) { renew(); }

Device& Devices::now() const {
  const std::lock_guard lock(lock_);
  return *all_.back();
}

void Devices::renew() {
  DeviceProbe& probe = options_.probe;
  if (probe.devices == 0) throw DeviceError("there is no further device to draw with");
  auto device = std::make_unique<Device>(options_);
  if (probe.devices > 0) --probe.devices;
  probe.submits = -1;
  const std::lock_guard lock(lock_);
  all_.push_back(std::move(device));
}

sunder_vulkan_host Device::lend() {
  sunder_vulkan_host host = SUNDER_VULKAN_HOST_INIT;
  host.api_version = VK_API_VERSION_1_2;
  host.get_instance_proc_addr = reinterpret_cast<sunder_vulkan_get_function>(get_);
  host.instance = instance_;
  host.physical_device = physical_;
  host.device = device_;
  host.queue = queue_;
  host.queue_family = family_;
  host.features = features_;
  host.lock = [](void* user) { static_cast<std::mutex*>(user)->lock(); };
  host.unlock = [](void* user) { static_cast<std::mutex*>(user)->unlock(); };
  host.lock_user = &lock_;
  return host;
}

namespace {

Owned<VkDeviceMemory> allocate(const Device& device, const VkMemoryRequirements& needs,
                               std::uint32_t type) {
  VkMemoryAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  info.allocationSize = needs.size;
  info.memoryTypeIndex = type;
  return make<VkDeviceMemory>(device, device.vk().AllocateMemory, info, device.vk().FreeMemory,
                              "vkAllocateMemory");
}

}  // namespace

HostBuffer::HostBuffer(const Device& device, std::size_t bytes, VkBufferUsageFlags usage,
                       bool read_back)
    : bytes_(bytes) {
  const DeviceFunctions& vk = device.vk();
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes;
  info.usage = usage;
  buffer_ = make<VkBuffer>(device, vk.CreateBuffer, info, vk.DestroyBuffer, "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vk.GetBufferMemoryRequirements(device.handle(), buffer_.get(), &needs);
  const VkMemoryPropertyFlags wanted =
      read_back ? VK_MEMORY_PROPERTY_HOST_CACHED_BIT : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  memory_ = allocate(
      device, needs,
      device.memory_type(needs.memoryTypeBits,
                         VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                         wanted));
  check(vk.BindBufferMemory(device.handle(), buffer_.get(), memory_.get(), 0),
        "vkBindBufferMemory");
  check(vk.MapMemory(device.handle(), memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

Image::Image(const Device& device, VkExtent2D size, VkFormat format, VkSampleCountFlagBits samples,
             VkImageUsageFlags usage, VkImageAspectFlags aspect) {
  const DeviceFunctions& vk = device.vk();
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {size.width, size.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = samples;
  info.usage = usage;
  image_ = make<VkImage>(device, vk.CreateImage, info, vk.DestroyImage, "vkCreateImage");
  VkMemoryRequirements needs{};
  vk.GetImageMemoryRequirements(device.handle(), image_.get(), &needs);
  memory_ =
      allocate(device, needs,
               device.memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
  check(vk.BindImageMemory(device.handle(), image_.get(), memory_.get(), 0), "vkBindImageMemory");
  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = image_.get();
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = {aspect, 0, 1, 0, 1};
  view_ =
      make<VkImageView>(device, vk.CreateImageView, view, vk.DestroyImageView, "vkCreateImageView");
}

}  // namespace sunder::app::view
