// SPDX-License-Identifier: Apache-2.0
// A logical device with one compute queue. Its handles may be its own or a host's: nothing but
// `owner` ever destroys them, so a trainer can lend instance, device and queue.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/vulkan/physical_device.hpp"
#include "gpu/vulkan/queue.hpp"
#include "sunder/pipeline_cache.hpp"

namespace sunder::vulkan {

/// Everything the kernels need of a device.
struct DeviceHandles {
  DeviceFunctions vk;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  QueueLock lock;  ///< of a borrowed queue
  VkPhysicalDeviceMemoryProperties memory{};
  bool int64 = false;           ///< shaderInt64 was enabled
  std::shared_ptr<void> owner;  ///< keeps instance and device alive; does nothing when borrowed
};

/// Time of a pass by the device's clock.
struct PassTime {
  const char* pass;
  double milliseconds = 0;

  [[nodiscard]] bool is(const char* name) const { return std::strcmp(pass, name) == 0; }
};

/// What tests ask of a device.
struct DeviceProbe {
  /// After so many submits every further one reports a lost device. Negative: never.
  int submits_until_lost = -1;
  /// Such a submit is taken and done, and the wait for it reports the loss.
  bool lost_in_wait = false;
  /// Such a submit is taken and done, and nobody hears of it; the wait for it ends after a
  /// millisecond.
  bool silent = false;
  /// Sentinel bytes before and after every buffer, a multiple of 256; a changed one is a message.
  std::size_t guard_bytes = 0;
  /// The device claims to have no more memory than this. 0: what it has.
  VkDeviceSize memory = 0;
  /// The device claims these limits.
  LimitsProbe limits;
  /// The device claims to lack shaderFloat64, and does not get it.
  bool no_float64 = false;
  /// The device claims to have no compute queue.
  bool no_compute = false;
  /// A processor that emulates a GPU passes for a discrete one: `auto` takes it, and the host
  /// reaches device-local memory by copies alone.
  bool as_gpu = false;
  /// Such a one, whose memory the host writes directly; it reads by copies.
  bool maps = false;
  /// Counts the device's allocations of memory, where given.
  std::size_t* allocations = nullptr;
};

class KernelCache;
class Uploads;

/// The first memory type among those allowed (by their bits) that has all of the first wish, else
/// of the next one.
[[nodiscard]] std::optional<std::uint32_t> choose_memory_type(
    const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
    std::span<const VkMemoryPropertyFlags> wishes);

/// What a device claims to be.
[[nodiscard]] PhysicalDevice probed(PhysicalDevice device, const DeviceProbe& probe);

class Device {
 public:
  Device(DeviceHandles handles, PhysicalDevice physical, std::shared_ptr<Messages> messages,
         DeviceProbe probe = {}, std::shared_ptr<PipelineCache> cache = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const DeviceFunctions& vk() const { return handles_.vk; }
  [[nodiscard]] VkDevice handle() const { return handles_.device; }
  [[nodiscard]] const PhysicalDevice& physical() const { return physical_; }
  [[nodiscard]] bool int64() const { return handles_.int64; }
  [[nodiscard]] std::size_t guard_bytes() const { return probe_.guard_bytes; }
  /// Reports a finding as a validation layer would.
  void report(std::string message) { messages_->texts.push_back(std::move(message)); }
  /// Whether command buffers recorded from now on time their passes; from the start on a device
  /// with a clock.
  [[nodiscard]] bool timing() const { return timing_; }
  void set_timing(bool on) { timing_ = on && physical_.timestamp_bits > 0; }
  void add_time(const char* pass, double milliseconds);
  /// Sums over all submits since the last call.
  [[nodiscard]] std::vector<PassTime> take_times() { return std::exchange(times_, {}); }
  [[nodiscard]] VkCommandPool command_pool() const { return pool_; }
  /// Null: nobody keeps what the driver makes of kernels.
  [[nodiscard]] VkPipelineCache pipeline_cache() const;

  /// As choose_memory_type(). Throws DeviceError where there is none.
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed,
                                          std::span<const VkMemoryPropertyFlags> wishes) const;
  [[nodiscard]] VkMemoryPropertyFlags memory_flags(std::uint32_t type) const {
    return handles_.memory.memoryTypes[type].propertyFlags;
  }

  [[nodiscard]] const Queue& queue() const { return queue_; }
  /// Submits and waits; what was written by uploads() goes before. Throws DeviceLost, or
  /// DeviceError with the first validation message.
  /// `then`: more that was recorded, in the same submit.
  void submit(VkCommandBuffer commands, VkCommandBuffer then = VK_NULL_HANDLE);
  /// Submits what was written, where something waits: before commands that somebody else submits.
  void flush();

  /// Submits without waiting; `done` is signalled at the end.
  void hand_over(const VkSubmitInfo& info, VkFence done);
  /// For what was handed over. Throws DeviceLost.
  void wait(VkFence done);

  /// By which buffers that are not mapped are written and read.
  [[nodiscard]] Uploads& uploads();
  /// A buffer goes that may have been written.
  void forget(VkBuffer buffer) noexcept;

  /// Bytes that buffers have handed to the host.
  [[nodiscard]] std::size_t bytes_read() const { return bytes_read_; }
  void count_read(std::size_t bytes) { bytes_read_ += bytes; }

  /// Bytes that buffers hold now, and the most they ever held; pipelines created so far, and those
  /// that exist, by the names of their kernels.
  [[nodiscard]] std::size_t held_bytes() const { return held_bytes_; }
  [[nodiscard]] std::size_t most_bytes() const { return most_bytes_; }
  [[nodiscard]] int pipelines() const { return pipelines_; }
  [[nodiscard]] const std::multiset<std::string>& living_pipelines() const { return living_; }
  void count_buffer(std::ptrdiff_t bytes) {
    held_bytes_ += static_cast<std::size_t>(bytes);
    most_bytes_ = std::max(most_bytes_, held_bytes_);
  }
  void count_pipeline(const std::string& name) {
    living_.insert(name);
    ++pipelines_;
  }
  void forget_pipeline(const std::string& name) noexcept {
    const auto it = living_.find(name);
    if (it != living_.end()) living_.erase(it);
  }
  /// Dispatches of all submits so far, those of no size too, and as often as they were recorded.
  [[nodiscard]] std::size_t dispatches() const { return dispatches_; }
  [[nodiscard]] std::size_t recorded() const { return recorded_; }
  void count_dispatches(std::size_t more) { dispatches_ += more; }
  void count_recorded() { ++recorded_; }
  /// Of memory, before it is made, with those of others that have the same device. Throws
  /// DeviceError where it has no more.
  void count_allocation();
  void forget_allocation() noexcept { --*allocations_; }

  /// Throws DeviceError when `bytes` more than the device's memory are asked for; `instead`: what
  /// would do.
  void require_memory(VkDeviceSize bytes, const std::string& purpose,
                      const std::string& instead = "route cg or a smaller mesh") const;

 private:
  void check_messages() const;
  template <class Wait>
  void wait_by(Wait&& wait);
  void submit(std::span<const VkCommandBuffer> commands);

  DeviceHandles handles_;
  PhysicalDevice physical_;
  std::shared_ptr<Messages> messages_;
  DeviceProbe probe_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::size_t bytes_read_ = 0, held_bytes_ = 0, most_bytes_ = 0, dispatches_ = 0, recorded_ = 0;
  std::shared_ptr<std::atomic<std::size_t>> allocations_;  // that live, of all who have the handle
  int pipelines_ = 0;
  std::multiset<std::string> living_;
  bool timing_;
  std::vector<PassTime> times_;
  Queue queue_;
  std::unique_ptr<Uploads> uploads_;  // null: nothing was written yet
  std::shared_ptr<PipelineCache> kept_;
  std::unique_ptr<KernelCache> cache_;  // null: nobody keeps it
};

/// Creates a device of its own. Throws DeviceError naming the shortcoming of `physical`.
[[nodiscard]] std::unique_ptr<Device> create_device(std::shared_ptr<const Instance> instance,
                                                    const PhysicalDevice& physical,
                                                    DeviceProbe probe = {},
                                                    std::shared_ptr<PipelineCache> cache = {});

}  // namespace sunder::vulkan
