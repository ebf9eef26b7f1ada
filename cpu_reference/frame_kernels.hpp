// SPDX-License-Identifier: Apache-2.0
// What a frame on the CPU runs, in order, for `plan`.
#pragma once

#include <vector>

#include "solver/frame_cost.hpp"

namespace sunder::cpu_reference {

[[nodiscard]] std::vector<KernelPlan> frame_kernels(const solver::FrameShape& shape,
                                                    const Needs& needs);

}  // namespace sunder::cpu_reference
