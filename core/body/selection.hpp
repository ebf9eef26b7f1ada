// SPDX-License-Identifier: Apache-2.0
// Selections of nodes and elements, resolved against a mesh.
#pragma once

#include <string>
#include <vector>

#include "sunder/scene.hpp"

namespace sunder {

/// Ids of the selected nodes, ascending, each once. `what` ("fixed 0", say) begins the message of
/// the InputError for an unknown surface, an id outside the mesh, or a selection of nothing.
[[nodiscard]] std::vector<Index> select_nodes(const Mesh& mesh, const NodeSelection& selection,
                                              const std::string& what);

/// Ids of the selected elements, ascending, each once; boxes select by centroid.
[[nodiscard]] std::vector<Index> select_elements(const Mesh& mesh,
                                                 const ElementSelection& selection,
                                                 const std::string& what);

}  // namespace sunder
