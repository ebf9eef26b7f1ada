// SPDX-License-Identifier: Apache-2.0
#include "gpu/vulkan/device.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <mutex>

#include "gpu/vulkan/check.hpp"
#include "gpu/vulkan/kernel_cache.hpp"
#include "gpu/vulkan/uploads.hpp"

namespace sunder::vulkan {
namespace {

/// Destroys a device of our own, then lets go of its instance.
struct OwnDevice {
  OwnDevice(std::shared_ptr<const Instance> of, VkDevice handle, PFN_vkDestroyDevice function)
      : instance(std::move(of)), device(handle), destroy(function) {}
  ~OwnDevice() { destroy(device, nullptr); }
  OwnDevice(const OwnDevice&) = delete;
  OwnDevice& operator=(const OwnDevice&) = delete;

  std::shared_ptr<const Instance> instance;
  VkDevice device;
  PFN_vkDestroyDevice destroy;
};

/// A function of Vulkan that returns nothing, and does nothing.
template <class Function>
struct Nothing;
template <class... Arguments>
struct Nothing<void(VKAPI_PTR*)(Arguments...)> {
  static VKAPI_ATTR void VKAPI_CALL call(Arguments...) {}
};
template <class... Functions>
void silence(Functions&... functions) {
  ((functions = Nothing<Functions>::call), ...);
}

/// What a device that does not answer still has at work must not be destroyed, ever.
void keep_forever(DeviceHandles& handles) {
  DeviceFunctions& vk = handles.vk;
  silence(vk.DestroyBuffer, vk.FreeMemory, vk.DestroyBufferView, vk.DestroyPipeline,
          vk.DestroyPipelineLayout, vk.DestroyDescriptorSetLayout, vk.DestroyDescriptorPool,
          vk.DestroyShaderModule, vk.DestroyCommandPool, vk.FreeCommandBuffers, vk.DestroyQueryPool,
          vk.DestroyFence, vk.DestroyPipelineCache);
  if (handles.owner) new std::shared_ptr<void>(std::move(handles.owner));
}

VkDevice create_handle(const Instance& instance, const PhysicalDevice& physical) {
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = static_cast<std::uint32_t>(physical.compute_family);
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceFeatures features{};
  features.shaderFloat64 = physical.float64 ? VK_TRUE : VK_FALSE;
  features.shaderInt64 = physical.int64 ? VK_TRUE : VK_FALSE;
  VkPhysicalDeviceSubgroupSizeControlFeatures control{};
  control.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES;
  control.subgroupSizeControl = VK_TRUE;
  std::vector<const char*> extensions;
  if (physical.portable_subset) extensions.push_back(kPortabilitySubset);
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  if (physical.subgroup_on_request) {
    info.pNext = &control;
    extensions.push_back(VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME);
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.pEnabledFeatures = &features;
  VkDevice device = VK_NULL_HANDLE;
  check(instance.vk().CreateDevice(physical.handle, &info, nullptr, &device), "vkCreateDevice");
  return device;
}

/// One counter for a handle, however often that is lent.
std::shared_ptr<std::atomic<std::size_t>> allocations_of(VkDevice device) {
  static std::mutex mutex;
  static std::map<VkDevice, std::weak_ptr<std::atomic<std::size_t>>> all;
  const std::lock_guard lock(mutex);
  std::erase_if(all, [](const auto& known) { return known.second.expired(); });
  auto counter = all[device].lock();
  if (!counter) all[device] = counter = std::make_shared<std::atomic<std::size_t>>(0);
  return counter;
}

}  // namespace

PhysicalDevice probed(PhysicalDevice device, const DeviceProbe& probe) {
  if (probe.memory > 0) device.memory = probe.memory;
  lower(device.limits, probe.limits);
  if (probe.no_float64) device.float64 = false;
  if (probe.no_compute) device.compute_family = -1;
  if (probe.as_gpu && device.is_cpu()) {
    device.type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    device.maps = probe.maps;
  }
  return device;
}

std::unique_ptr<Device> create_device(std::shared_ptr<const Instance> instance,
                                      const PhysicalDevice& unprobed, DeviceProbe probe,
                                      std::shared_ptr<PipelineCache> cache) {
  const PhysicalDevice physical = probed(unprobed, probe);
  const std::string shortcoming = physical.shortcoming();
  if (!shortcoming.empty()) {
    throw DeviceError("the Vulkan device \"" + physical.name + "\" cannot be used: " + shortcoming +
                      "; update its driver or use backend cpu");
  }
  DeviceHandles handles;
  handles.device = create_handle(*instance, physical);
  handles.vk = load_functions(instance->vk().GetDeviceProcAddr, handles.device);
  handles.owner = std::make_shared<OwnDevice>(instance, handles.device, handles.vk.DestroyDevice);
  handles.family = static_cast<std::uint32_t>(physical.compute_family);
  handles.int64 = physical.int64;
  handles.vk.GetDeviceQueue(handles.device, handles.family, 0, &handles.queue);
  instance->vk().GetPhysicalDeviceMemoryProperties(physical.handle, &handles.memory);
  return std::make_unique<Device>(std::move(handles), physical, instance->messages(), probe,
                                  std::move(cache));
}

Device::Device(DeviceHandles handles, PhysicalDevice physical, std::shared_ptr<Messages> messages,
               DeviceProbe probe, std::shared_ptr<PipelineCache> cache)
    : handles_(std::move(handles)),
      physical_(std::move(physical)),
      messages_(std::move(messages)),
      probe_(probe),
      allocations_(allocations_of(handles_.device)),
      timing_(physical_.timestamp_bits > 0),
      queue_(handles_.vk, handles_.device, handles_.queue, handles_.lock,
             physical_.is_cpu() ? kPatienceWithAProcessor : kPatience),
      kept_(std::move(cache)) {
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.queueFamilyIndex = handles_.family;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  check(vk().CreateCommandPool(handle(), &pool, nullptr, &pool_), "vkCreateCommandPool");
  if (!kept_) return;
  cache_ = std::make_unique<KernelCache>(vk(), handle(), physical_, kept_->bytes());
  kept_->follow(this, cache_->ignored(), [this] { return cache_->bytes(); });
}

VkPipelineCache Device::pipeline_cache() const { return cache_ ? cache_->handle() : nullptr; }

Device::~Device() {
  if (kept_) kept_->leave(this);
  cache_.reset();
  uploads_.reset();
  vk().DestroyCommandPool(handle(), pool_, nullptr);
}

std::optional<std::uint32_t> choose_memory_type(const VkPhysicalDeviceMemoryProperties& memory,
                                                std::uint32_t allowed,
                                                std::span<const VkMemoryPropertyFlags> wishes) {
  for (const VkMemoryPropertyFlags wanted : wishes) {
    for (std::uint32_t t = 0; t < memory.memoryTypeCount; ++t) {
      const VkMemoryPropertyFlags has = memory.memoryTypes[t].propertyFlags;
      if ((allowed >> t & 1) && (has & wanted) == wanted) return t;
    }
  }
  return {};
}

std::uint32_t Device::memory_type(std::uint32_t allowed,
                                  std::span<const VkMemoryPropertyFlags> wishes) const {
  if (const auto type = choose_memory_type(handles_.memory, allowed, wishes)) return *type;
  throw DeviceError("the Vulkan device \"" + physical_.name + "\" has no memory of the kind asked");
}

void Device::count_allocation() {
  const std::size_t now = ++*allocations_;
  try {
    physical_.require(now, physical_.limits.allocations, "a scene");
  } catch (const DeviceError&) {
    forget_allocation();
    throw;
  }
  if (probe_.allocations) ++*probe_.allocations;
}

void Device::require_memory(VkDeviceSize bytes, const std::string& purpose,
                            const std::string& instead) const {
  if (bytes <= physical_.memory) return;
  throw DeviceError(purpose + " needs " + std::to_string(bytes) + " bytes on the device \"" +
                    physical_.name + "\", which has " + std::to_string(physical_.memory) +
                    "; use precision fp32, " + instead);
}

void Device::add_time(const char* pass, double milliseconds) {
  for (PassTime& sum : times_) {
    if (!sum.is(pass)) continue;
    sum.milliseconds += milliseconds;
    return;
  }
  times_.push_back({pass, milliseconds});
}

Uploads& Device::uploads() {
  if (!uploads_) uploads_ = std::make_unique<Uploads>(*this);
  return *uploads_;
}

void Device::forget(VkBuffer buffer) noexcept {
  if (uploads_) uploads_->forget(buffer);
}

void Device::submit(VkCommandBuffer commands, VkCommandBuffer then) {
  const VkCommandBuffer written = uploads_ ? uploads_->record() : VK_NULL_HANDLE;
  const std::array<VkCommandBuffer, 3> all{written, commands, then};
  const std::size_t first = written ? 0 : 1, last = then ? 3 : 2;
  submit(std::span(all).subspan(first, last - first));
  if (uploads_) uploads_->clear();
}

void Device::flush() {
  const VkCommandBuffer written = uploads_ ? uploads_->record() : VK_NULL_HANDLE;
  if (!written) return;
  submit({&written, 1});
  uploads_->clear();
}

void Device::hand_over(const VkSubmitInfo& info, VkFence done) {
  flush();
  queue_.submit(info, done);
}

template <class Wait>
void Device::wait_by(Wait&& wait) {
  try {
    wait();
  } catch (const DeviceLost&) {
    if (queue_.silent()) keep_forever(handles_);
    throw;
  }
}

void Device::submit(std::span<const VkCommandBuffer> commands) {
  check_messages();
  const bool lost = probe_.submits_until_lost == 0;
  if (lost && !probe_.lost_in_wait && !probe_.silent)
    check(VK_ERROR_DEVICE_LOST, "a submit (injected fault)");
  if (probe_.submits_until_lost > 0) --probe_.submits_until_lost;
  const bool silent = lost && probe_.silent;
  if (silent) queue_.set_patience(std::chrono::milliseconds(1));
  queue_.submit(commands, !silent);
  wait_by([&] { queue_.wait(); });
  if (lost) check(VK_ERROR_DEVICE_LOST, "a wait (injected fault)");
  check_messages();
}

void Device::wait(VkFence done) {
  wait_by([&] { queue_.wait(done); });
}

void Device::check_messages() const {
  if (messages_->texts.empty()) return;
  throw DeviceError("Vulkan validation: " + messages_->texts.front());
}

}  // namespace sunder::vulkan
