// SPDX-License-Identifier: Apache-2.0
// Whether the interfaces of a scene can be laid (lay_interfaces.hpp).
#pragma once

#include <string>

#include "sunder/scene.hpp"

namespace sunder::fem {

/// What begins messages: its number and its volumes.
[[nodiscard]] std::string interface_name(const Scene& scene, std::size_t interface);

/// Whether the mesh has its layer already.
[[nodiscard]] bool is_laid(const Scene& scene, std::size_t interface);

/// Throws InputError for what no body can have. That volumes share a face is seen as they are laid.
void check_interfaces(const Scene& scene);

}  // namespace sunder::fem
