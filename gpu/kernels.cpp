// SPDX-License-Identifier: Apache-2.0
#include "gpu/kernels.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include "shaders/embedded.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {
namespace {

vulkan::Access access(Reads reads, Variant variant, bool fp64, bool single) {
  if (variant == Variant::gpu || reads == Reads::plain) return vulkan::Access::storage;
  if ((reads == Reads::reals && !fp64) || (reads == Reads::doubles && single))
    return vulkan::Access::texel_float4;
  return vulkan::Access::texel_uint4;
}

constexpr std::pair<std::string_view, std::string_view> kRoles[] = {
    {"add", "u += du, where a solution is refined"},
    {"apply", "the inverse's columns that carry load, summed in chunks"},
    {"cg_begin", "residual and first direction of conjugate gradients"},
    {"cg_check", "whether conjugate gradients go on"},
    {"cg_coarse", "rigid motions of groups of nodes: their equations solved"},
    {"cg_direction", "next direction of conjugate gradients"},
    {"cg_length", "length of a step of conjugate gradients"},
    {"cg_multiply", "K p by 3 x 3 blocks"},
    {"cg_restrict", "rigid motions of groups of nodes: their share of the residual"},
    {"cg_step", "step of conjugate gradients, and its preconditioner"},
    {"complement", "last step of the inversion on the device"},
    {"dense", "dense product with the inverse, to estimate errors and refine"},
    {"display", "fields as a host draws them"},
    {"gather", "values that the host asks for, side by side"},
    {"hold", "gripped unknowns at exactly what is prescribed"},
    {"low_rank", "update of the inverse, rank 6 for each destroyed element"},
    {"narrow", "a vector rounded to what the inverse is stored in"},
    {"pick", "entries of the inverse that an event needs"},
    {"project", "the exact columns' products with the residual"},
    {"residual", "f - K u by 3 x 3 blocks, reactions of grips"},
    {"solve", "u from the exact columns that carry load and damage"},
    {"stress", "stress of all elements: ratios to yield, and the norm for the error estimate"},
    {"sum", "chunks of a product added up in order"},
    {"summary", "what a frame returns, from all workgroups' partial results"},
    {"update_vectors", "update vectors of destroyed elements through the inverse"},
};

/// Of "stress_lvp_fp64": "stress".
std::string_view without_variant(std::string_view name) {
  for (const std::string_view variant : {"_gpu_", "_lvp_"}) {
    const std::size_t at = name.find(variant);
    if (at != std::string_view::npos) return name.substr(0, at);
  }
  return name;
}

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

std::vector<KernelPlan> describe(const std::multiset<std::string>& pipelines) {
  std::vector<KernelPlan> plan;
  for (auto it = pipelines.begin(); it != pipelines.end(); it = pipelines.upper_bound(*it)) {
    const auto* role = std::ranges::find(kRoles, without_variant(*it),
                                         &std::pair<std::string_view, std::string_view>::first);
    const std::size_t count = pipelines.count(*it);
    std::string does(role != std::end(kRoles) ? role->second : std::string_view("?"));
    if (count > 1) does += " (" + std::to_string(count) + " pipelines)";
    plan.push_back({*it, std::move(does)});
  }
  return plan;
}

std::unique_ptr<vulkan::Kernel> KernelFactory::make(std::string_view name, bool fp64,
                                                    std::initializer_list<Reads> bindings,
                                                    std::size_t push_bytes, std::uint32_t group,
                                                    std::uint32_t choice) const {
  const std::string full = std::string(name) + (variant_ == Variant::gpu ? "_gpu_" : "_lvp_") +
                           (single() ? "single"
                            : fp64   ? "fp64"
                                     : "fp32");
  vulkan::KernelCode code;
  code.name = full;
  code.spirv = shaders::find(full);
  if (code.spirv.empty()) throw DeviceError("this build lacks the kernel " + full);
  std::vector<vulkan::Access> accesses;
  for (Reads r : bindings) accesses.push_back(access(r, variant_, fp64, single()));
  code.bindings = accesses;
  code.push_bytes = static_cast<std::uint32_t>(push_bytes);
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
