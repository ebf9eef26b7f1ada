// SPDX-License-Identifier: Apache-2.0
// The CPU reference backend: double precision, Eigen, plain. The yardstick of every other backend.
#pragma once

#include <memory>

#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

/// The processor, as `sunder devices` lists it.
[[nodiscard]] DeviceInfo device();

/// Creates it for a problem. Throws DeviceError for a route or precision that it does not offer,
/// InputError when the route needs more memory than the machine has.
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs);

}  // namespace sunder::cpu_reference
