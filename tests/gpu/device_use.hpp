// SPDX-License-Identifier: Apache-2.0
// What the tests of a device's use share.
#pragma once

#include "gpu_body.hpp"

namespace sunder::test {

using DeviceUse = WithVulkan<>;

inline Needs needs_with(bool damage) {
  Needs needs;
  needs.stress = needs.yield = true;
  needs.damage = damage;
  return needs;
}

/// Validation is on, with sentinels round every buffer.
inline gpu::VulkanOptions watched(const Way& way = {}) {
  gpu::VulkanOptions options;
  options.instance.validation = validated();
  options.variant = way.variant;
  options.probe = watched_probe();
  return options;
}

inline std::shared_ptr<const Problem> problem_for(Scene scene, const Way& way) {
  scene.solver.backend = "vulkan";
  scene.solver.precision = way.precision;
  scene.solver.update = way.update;
  scene.solver.route = way.route;
  scene.solver.tolerance = way.tolerance;
  return std::make_shared<const Problem>(std::move(scene));
}

inline Scene all_pooled(Scene scene) {
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  return scene;
}

inline bool has_kernel(const Backend& backend, const std::string& name) {
  return std::ranges::any_of(backend.kernels(), [&](const KernelPlan& kernel) {
    return kernel.name.starts_with(name + "_");
  });
}

}  // namespace sunder::test
