// SPDX-License-Identifier: Apache-2.0
// What a simulation on a host's device has there for passes that write to the host's buffers.
#pragma once

#include "gpu/kernels.hpp"

namespace sunder::gpu {

/// Null: it is not there. The backend must outlive it.
struct LentField {
  const KernelFactory* kernels = nullptr;
  const vulkan::Buffer* displacement = nullptr;  ///< at all nodes (Fields::nodal)
  const vulkan::Buffer* stress = nullptr;        ///< of all elements (Fields::stress)
};

}  // namespace sunder::gpu
