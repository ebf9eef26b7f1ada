// SPDX-License-Identifier: Apache-2.0
// The backend cpu for bodies in motion, by any law.
#pragma once

#include <memory>

#include "cpu_reference/cpu_reference.hpp"

namespace sunder::cpu_reference {

/// Throws as create() does.
[[nodiscard]] std::unique_ptr<Backend> create_motion(std::shared_ptr<const Problem> problem,
                                                     Needs needs, const CpuOptions& options);

}  // namespace sunder::cpu_reference
