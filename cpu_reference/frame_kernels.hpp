// SPDX-License-Identifier: Apache-2.0
// What a frame on the CPU runs, in order, for `plan`.
#pragma once

#include <vector>

#include "cpu_reference/cost_model.hpp"
#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

[[nodiscard]] std::vector<KernelPlan> frame_kernels(const FrameShape& shape, const Needs& needs,
                                                    std::size_t grips);

}  // namespace sunder::cpu_reference
