// SPDX-License-Identifier: Apache-2.0
// Which base and which update carry a scene on the CPU, and why.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "body/analysis.hpp"
#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

struct ChosenRoute {
  Route route = Route::automatic;
  Update update = Update::automatic;
  std::string why;
  /// Of the intact body's factor; empty: there is no room for it, and an incomplete one
  /// preconditions conjugate gradients.
  std::unique_ptr<const fem::Analysis> analysis;
};

/// In so many bytes. Throws DeviceError for what the CPU does not offer (with what it does),
/// InputError when the route asked for needs more, or any does.
[[nodiscard]] ChosenRoute choose_route(const Problem& problem, const Needs& needs,
                                       std::size_t memory);

/// As in a scene: "inverse", "condensed", "factor", "cg".
[[nodiscard]] std::string name_of(Route route);
/// "eager", "deferred"; "matrix" for cg, whose only update is the matrix itself.
[[nodiscard]] std::string name_of_update(const ChosenRoute& chosen);

/// Bytes that can be had without swapping: free ones and what caches files, within what a container
/// is allowed.
[[nodiscard]] std::size_t available_memory();

}  // namespace sunder::cpu_reference
