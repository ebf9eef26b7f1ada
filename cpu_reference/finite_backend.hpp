// SPDX-License-Identifier: Apache-2.0
// The backend cpu for bodies with a law of finite deformation.
#pragma once

#include <memory>

#include "cpu_reference/cpu_reference.hpp"

namespace sunder::cpu_reference {

/// Throws as create() does.
[[nodiscard]] std::unique_ptr<Backend> create_finite(std::shared_ptr<const Problem> problem,
                                                     Needs needs, const CpuOptions& options);

}  // namespace sunder::cpu_reference
