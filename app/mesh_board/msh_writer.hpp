// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sunder/mesh.hpp"

namespace sunder::app {

/// The mesh as a .msh file of version 4.1, as text or binary. Nodes and elements keep their order
/// in the file as far as their volumes allow: each volume's block is in order, blocks by volume.
[[nodiscard]] std::string to_msh(const Mesh& mesh, bool ascii);

/// Reorders nodes and elements by volume, so that to_msh writes them in exactly this order.
void order_by_volume(Mesh& mesh);

}  // namespace sunder::app
