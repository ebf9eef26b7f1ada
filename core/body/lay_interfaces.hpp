// SPDX-License-Identifier: Apache-2.0
// Makes the layers of a scene's interfaces (method.md "Interfaces").
#pragma once

#include "sunder/scene.hpp"

namespace sunder::fem {

/// Name of the volume that the elements of a scene's interface make.
[[nodiscard]] std::string interface_volume(std::size_t interface);

/// Splits the nodes of the mesh along the scene's interfaces, where they are not laid yet, and adds
/// the elements of the layers behind the mesh's, with a volume and a material for each interface.
/// Ids of nodes and elements stay; of a node's copies the one of its first element keeps its id.
/// Throws InputError.
void lay_interfaces(Scene& scene);

/// What a layer of a thickness is made of, so that in tension it bears the strength at most and
/// takes the energy: its law is neo-Hookean with lambda = 0 (method.md "Interfaces").
struct LayerLaw {
  double mu = 0;       ///< [MPa]
  double opening = 0;  ///< at which it parts in tension [mm]
};
[[nodiscard]] LayerLaw layer_law(double strength, double energy, double thickness);

}  // namespace sunder::fem
