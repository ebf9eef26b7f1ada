// SPDX-License-Identifier: Apache-2.0
// Which base and which update carry a scene on the CPU, and why.
#pragma once

#include <cstddef>
#include <string>

#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

struct ChosenRoute {
  Route route = Route::automatic;
  Update update = Update::automatic;
  std::string why;
};

/// Throws DeviceError for what the CPU does not offer (with what it does), InputError when the
/// route asked for needs more memory than is free.
[[nodiscard]] ChosenRoute choose_route(const Problem& problem, const Needs& needs);

/// As in a scene: "inverse", "condensed", "factor", "cg".
[[nodiscard]] std::string name_of(Route route);
/// "eager", "deferred"; "matrix" for cg, whose only update is the matrix itself.
[[nodiscard]] std::string name_of_update(const ChosenRoute& chosen);

/// Bytes of free memory.
[[nodiscard]] std::size_t available_memory();

}  // namespace sunder::cpu_reference
