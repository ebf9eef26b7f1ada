// SPDX-License-Identifier: Apache-2.0
// The backend on Vulkan compute shaders: any Vulkan 1.2 device; without shaderFloat64 route inverse
// in fp32 alone.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/lent_field.hpp"
#include "gpu/passes/display.hpp"
#include "gpu/vulkan/commands.hpp"
#include "gpu/vulkan/lent_device.hpp"
#include "solver/frame_cost.hpp"
#include "sunder/backend.hpp"

namespace sunder::gpu {

/// What a host or a test sets beside the scene's options.
struct VulkanOptions {
  vulkan::InstanceOptions instance;
  vulkan::DeviceProbe probe;
  std::optional<Variant> variant;        ///< none: chosen by driver (choose_variant)
  std::size_t panel_bytes = 0;           ///< largest buffer of the inverse, 0: the device's limit
  std::optional<bool> invert_on_device;  ///< none: on a GPU, for larger scenes
  std::optional<bool> region_on_device;  ///< product of route condensed; none: on a GPU, where long
  std::optional<bool> damage_on_device;  ///< its small matrices; none: on a GPU, where worth it
  std::optional<vulkan::LentDevice> lent;  ///< a host's device; none: one of our own
  DisplayTargets display;                  ///< on a host's device: where to put what it draws
  std::shared_ptr<PipelineCache> cache;    ///< of the host's; null: nobody keeps it
};

/// Options from the environment: SUNDER_VULKAN_VALIDATION=1 turns the validation layers on and
/// their messages into errors. For tests: SUNDER_VULKAN_NO_FLOAT64=1 takes shaderFloat64 away, and
/// SUNDER_VULKAN_PROBE lists what else the device pretends, separated by commas: as_gpu, maps,
/// no_compute, memory=BYTES, lost=SUBMITS (vulkan::DeviceProbe), and limits by their names in
/// vulkan::LimitsProbe. Throws UsageError for another word.
[[nodiscard]] VulkanOptions options_from_environment();

/// All Vulkan devices of the machine; empty without loader or driver. The one that `auto` would
/// take is marked; a processor that emulates a GPU never is.
[[nodiscard]] std::vector<DeviceInfo> devices();

/// Measures what devices do in a second: those that can run the kernels and of which nothing is
/// kept, or with `again` all that can. Keeps it for plans (gpu/device_rates.hpp). Returns a
/// sentence for each of which that did not succeed; it is predicted by its kind, or as was kept
/// before.
[[nodiscard]] std::vector<std::string> measure_devices(bool again);

/// Why `auto` finds no GPU, with what to do about it; an empty sentence where there is none to be
/// missed, for the only devices are processors that emulate one. None: there is a GPU.
[[nodiscard]] std::optional<std::string> missing_gpu();

/// Creates it for a problem, on the device that the scene names or the first GPU (without one: the
/// first device). Throws DeviceError: no loader, no driver, no such device, a feature, a route or
/// memory missing.
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs);
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                              const VulkanOptions& options);

/// What a host draws, of a backend on a lent device; else null.
[[nodiscard]] Display* display_of(Backend& backend);

/// Of a backend on a lent device, for passes there that must go before it; else nulls.
[[nodiscard]] LentField lent_field(Backend& backend);

/// What a backend that create() returned holds and has held on its device; else nothing.
struct DeviceUse {
  std::size_t bytes = 0;        ///< of buffers, now
  std::size_t most_bytes = 0;   ///< at any time so far
  std::size_t submits = 0;      ///< so far
  int pipelines = 0;            ///< created so far
  std::size_t dispatches = 0;   ///< so far, those of no size too
  std::size_t recorded = 0;     ///< of these, as often as they were recorded
  std::size_t host_solves = 0;  ///< right sides that the host's factors have solved for so far
};
[[nodiscard]] DeviceUse device_use(const Backend& backend);

/// What a frame of such a backend will take, by these rates; none: by those of its device. Of
/// another one nothing.
[[nodiscard]] solver::FrameCost predicted(const Backend& backend,
                                          const std::optional<solver::FrameRates>& by = {});

/// Live breakable elements at or over yield after the last solve, ascending, as the device listed
/// them: only they cross to the host. Of a backend that create() returned; else empty.
[[nodiscard]] std::vector<Index> over_yield(const Backend& backend);

/// Bytes of fields read back to the host so far, by such a backend; else 0. What a frame returns
/// by itself (its summary) does not count.
[[nodiscard]] std::size_t bytes_read(const Backend& backend);

/// What the scene asked for and will cost more than it seems; empty for another backend.
[[nodiscard]] std::vector<std::string> warnings(const Backend& backend);

}  // namespace sunder::gpu
