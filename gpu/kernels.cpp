// SPDX-License-Identifier: Apache-2.0
#include "gpu/kernels.hpp"

#include <cstdlib>
#include <string>

#include "shaders/embedded.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

/// What a device that is not lavapipe may lack for its variant.
void require_lvp(const vulkan::PhysicalDevice& device) {
  const char* missing = !device.int64              ? "64-bit integers"
                        : !device.subgroup_known() ? "subgroups of a known size"
                                                   : nullptr;
  if (!missing) return;
  throw UsageError("SUNDER_SHADER_VARIANT is \"lvp\", but the device \"" + device.name +
                   "\" lacks " + missing + "; use gpu");
}

}  // namespace

vulkan::Access access(Reads reads, Variant variant, bool fp64, bool single) {
  if (variant == Variant::gpu || reads == Reads::plain) return vulkan::Access::storage;
  if ((reads == Reads::reals && !fp64) || (reads == Reads::doubles && single))
    return vulkan::Access::texel_float4;
  return vulkan::Access::texel_uint4;
}

std::vector<KernelPlan> describe(const std::multiset<std::string>& pipelines) {
  std::vector<KernelPlan> plan;
  for (auto it = pipelines.begin(); it != pipelines.end(); it = pipelines.upper_bound(*it)) {
    const std::size_t count = pipelines.count(*it);
    std::string does(kernel_row(without_variant(*it)).does);
    if (count > 1) does += " (" + std::to_string(count) + " pipelines)";
    plan.push_back({*it, std::move(does)});
  }
  return plan;
}

std::unique_ptr<vulkan::Kernel> KernelFactory::make(std::string_view name, bool fp64,
                                                    std::uint32_t group,
                                                    std::uint32_t choice) const {
  const KernelRow& row = kernel_row(name);
  const std::string full = std::string(name) + (variant_ == Variant::gpu ? "_gpu_" : "_lvp_") +
                           (single() ? "single"
                            : fp64   ? "fp64"
                                     : "fp32");
  vulkan::KernelCode code;
  code.name = full;
  code.spirv = shaders::find(full);
  if (code.spirv.empty()) throw DeviceError("this build lacks the kernel " + full);
  std::vector<vulkan::Access> accesses;
  for (Reads r : row.bindings.list()) accesses.push_back(access(r, variant_, fp64, single()));
  code.bindings = accesses;
  code.push_bytes = static_cast<std::uint32_t>(row.push_bytes);
  const std::uint32_t constants[] = {group, device_.physical().subgroup, choice};
  code.constants = constants;
  if (emulated()) code.subgroup = device_.physical().subgroup;  // shaders/reduce.glsl
  return std::make_unique<vulkan::Kernel>(device_, code);
}

std::uint32_t KernelFactory::parts() const {
  return variant_ == Variant::gpu ? 1 : shaders::kGroup / device_.physical().subgroup;
}

Variant choose_variant(const vulkan::PhysicalDevice& device) {
  const char* asked = std::getenv("SUNDER_SHADER_VARIANT");
  if (asked && *asked) {
    const std::string_view name = asked;
    if (name == "gpu") return Variant::gpu;
    if (name == "lvp") {
      require_lvp(device);
      return Variant::lvp;
    }
    throw UsageError("SUNDER_SHADER_VARIANT is \"" + std::string(name) +
                     "\"; it may be gpu or lvp");
  }
  // The lvp variant stores fp32 in 64-bit words; a host may not have enabled them.
  return device.driver_id == VK_DRIVER_ID_MESA_LLVMPIPE && device.int64 ? Variant::lvp
                                                                        : Variant::gpu;
}

}  // namespace sunder::gpu
