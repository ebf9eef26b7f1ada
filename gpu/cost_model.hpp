// SPDX-License-Identifier: Apache-2.0
// What a frame will take on a device, from the bytes that its passes read and the dispatches and
// submits that it is made of. For `plan`: right to a small factor, from nominal rates of a kind of
// device; `plan --measure` measures.
#pragma once

#include <cstddef>

#include "gpu/vulkan/physical_device.hpp"

namespace sunder::gpu {

struct FrameShape {
  bool cg = false, eager = false;   ///< the route and the update
  bool host_corrects = false;       ///< the device lacks shaderFloat64
  bool damage = false;              ///< something can be destroyed
  std::size_t real_bytes = 4;       ///< of a value of the inverse and of stress
  std::size_t rows = 0;             ///< of the inverse, padded
  std::size_t grips = 0;            ///< gripped unknowns
  std::size_t loaded = 0;           ///< unknowns with a force
  std::size_t elements = 0;         ///< on the device
  std::size_t stiffness_bytes = 0;  ///< that f - K u reads
  bool stress = false;              ///< is kept
  bool norms = true;                ///< stress is computed at all
};

struct FrameCost {
  double quiet_ms = 0;
  double fracture_ms = 0;  ///< 0: nothing can be destroyed
  // What the passes on the device read and write at least.
  double quiet_bytes = 0, fracture_bytes = 0;
};

[[nodiscard]] FrameCost frame_cost(const FrameShape& shape, const vulkan::PhysicalDevice& device);

}  // namespace sunder::gpu
