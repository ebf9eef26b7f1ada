// SPDX-License-Identifier: Apache-2.0
// The Vulkan device that pictures are drawn on, and what lives on it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "app/view/vulkan/functions.hpp"
#include "sunder/sunder_vulkan.h"
#include "sunder/types.hpp"

namespace sunder::app::view {

/// What tests ask of the devices that draw.
struct DeviceProbe {
  /// After so many submits the first device reports that it is lost, and ever after. Negative:
  /// never.
  int submits = -1;
  /// Where there is a file of that name, a submit, or the showing of a picture in a window, takes
  /// it away and reports the loss. Empty: there is none.
  std::filesystem::path submit_file, present_file;
  /// Devices that can be made. Negative: as many as one likes.
  int devices = -1;
};

/// What SUNDER_VIEW_PROBE asks for. Throws UsageError for what it may not have.
[[nodiscard]] DeviceProbe probe_from_environment();

/// What a window adds: extensions, and which device can show pictures on it.
struct DeviceOptions {
  DeviceProbe probe;
  int index = kNone;  ///< among all devices, kNone: the first GPU, else the first device
  std::vector<const char*> instance_extensions, device_extensions;
  /// Called with the instance before a device is chosen.
  std::function<void(VkInstance, PFN_vkGetInstanceProcAddr)> with_instance;
  /// Whether a queue family of a device will do; empty: any that draws.
  std::function<bool(VkPhysicalDevice, std::uint32_t)> presents;
};

class Device {
 public:
  /// Throws DeviceError: no loader, no such device, none that draws.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const DeviceFunctions& vk() const { return vk_; }
  [[nodiscard]] VkDevice handle() const { return device_; }
  [[nodiscard]] VkInstance instance() const { return instance_; }
  [[nodiscard]] VkPhysicalDevice physical() const { return physical_; }
  [[nodiscard]] VkQueue queue() const { return queue_; }
  [[nodiscard]] std::uint32_t family() const { return family_; }
  [[nodiscard]] PFN_vkGetInstanceProcAddr get() const { return get_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Hands it over, with the queue held. Throws DeviceLost, or DeviceError.
  void submit(const VkSubmitInfo& info, VkFence done);
  /// Until nothing of it runs any more, with the queue held: no other thread may submit meanwhile.
  void wait_idle();
  /// Shows an image by a window's own function, with the queue held.
  [[nodiscard]] VkResult present(PFN_vkQueuePresentKHR by, const VkPresentInfoKHR& info);

  /// A memory type among `allowed` with all these properties, and with `wanted` where there is one.
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags needed,
                                          VkMemoryPropertyFlags wanted) const;

  /// To be lent to a simulation (sunder_vulkan.h); while it lives this must.
  [[nodiscard]] sunder_vulkan_host lend();

 private:
  void open_loader();
  void create_instance(const DeviceOptions& options);
  void choose(const DeviceOptions& options);
  void create_device(const DeviceOptions& options);
  void close() noexcept;

  void* library_ = nullptr;
  PFN_vkGetInstanceProcAddr get_ = nullptr;
  InstanceFunctions of_instance_;
  DeviceFunctions vk_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0, features_ = 0;  // the latter as sunder_vulkan.h has them
  VkPhysicalDeviceMemoryProperties memory_{};
  std::string name_;
  std::mutex lock_;  // whoever submits holds it
  DeviceProbe probe_;
};

/// The device that draws now, and those that were lost before: a simulation may still hold what is
/// of them, so that they go when this does.
class Devices {
 public:
  /// Makes the first. Throws DeviceError.
  explicit Devices(DeviceOptions options);

  /// Stays as it is until this goes, whatever comes after it. Any thread may ask.
  [[nodiscard]] Device& now() const;
  /// Makes another in place of one that was lost. Throws DeviceError, and nothing changes.
  void renew();

 private:
  DeviceOptions options_;
  mutable std::mutex lock_;
  std::vector<std::unique_ptr<Device>> all_;  // the last one draws
};

/// One object of a device, destroyed with this.
template <class T>
class Owned {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, T, const VkAllocationCallbacks*);
  Owned() = default;
  Owned(const Device& device, T handle, Destroy destroy)
      : device_(device.handle()), handle_(handle), destroy_(destroy) {}
  Owned(Owned&& other) noexcept
      : device_(other.device_),
        handle_(std::exchange(other.handle_, T{})),
        destroy_(other.destroy_) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
    return *this;
  }
  ~Owned() {
    if (handle_) destroy_(device_, handle_, nullptr);
  }

  [[nodiscard]] T get() const { return handle_; }
  [[nodiscard]] const T* address() const { return &handle_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  T handle_ = T{};
  Destroy destroy_ = nullptr;
};

/// Makes one by vkCreateX(device, info, nullptr, &handle).
template <class T, class Create, class Info>
[[nodiscard]] Owned<T> make(const Device& device, Create create, const Info& info,
                            typename Owned<T>::Destroy destroy, const char* call) {
  T handle = T{};
  check(create(device.handle(), &info, nullptr, &handle), call);
  return {device, handle, destroy};
}

/// Memory that the host writes or reads in place.
class HostBuffer {
 public:
  HostBuffer() = default;
  HostBuffer(const Device& device, std::size_t bytes, VkBufferUsageFlags usage, bool read_back);

  [[nodiscard]] VkBuffer get() const { return buffer_.get(); }
  [[nodiscard]] std::size_t size() const { return bytes_; }
  template <class T>
  [[nodiscard]] T* as() const {
    return static_cast<T*>(mapped_);
  }

 private:
  // The buffer goes before its memory.
  Owned<VkDeviceMemory> memory_;
  Owned<VkBuffer> buffer_;
  std::size_t bytes_ = 0;
  void* mapped_ = nullptr;
};

/// An image that a device draws into, with its view.
class Image {
 public:
  Image() = default;
  Image(const Device& device, VkExtent2D size, VkFormat format, VkSampleCountFlagBits samples,
        VkImageUsageFlags usage, VkImageAspectFlags aspect);

  [[nodiscard]] VkImage get() const { return image_.get(); }
  [[nodiscard]] VkImageView view() const { return view_.get(); }

 private:
  Owned<VkDeviceMemory> memory_;
  Owned<VkImage> image_;
  Owned<VkImageView> view_;
};

}  // namespace sunder::app::view
