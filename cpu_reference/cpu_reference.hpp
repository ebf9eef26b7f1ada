// SPDX-License-Identifier: Apache-2.0
// The CPU reference backend: double precision, Eigen. Its own yardstick is cpu_reference/plain.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

/// The processor, as `sunder devices` lists it.
[[nodiscard]] DeviceInfo device();
/// What every backend on it says of itself; route, update and the rest are still to come.
[[nodiscard]] BackendInfo info_of_device();

class PreparedBodies;

/// What is set beside the scene's options, most of it by tests.
struct CpuOptions {
  std::size_t memory = 0;  ///< bytes that it may take; 0: those that are free
  /// The thread that makes new bases rests so long before each thing that it does: no result may
  /// depend on how long it takes.
  std::chrono::milliseconds rest{0};
  /// Null: this backend shares nothing with others.
  std::shared_ptr<PreparedBodies> prepared = {};
};

/// Creates it for a problem. Throws DeviceError for a route or precision that it does not offer,
/// InputError when the route asked for needs more memory than there is, or any does.
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs);
[[nodiscard]] std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                              const CpuOptions& options);

}  // namespace sunder::cpu_reference
