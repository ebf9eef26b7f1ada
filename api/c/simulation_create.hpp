// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c/simulation.hpp"
#include "c/structs.hpp"

namespace sunder::c {

/// A simulation of a scene on the backend that `create` makes, to be called within call().
/// `again`: it may be called later on as well.
void create_simulation(const SceneObject& scene, const sunder_callbacks* callbacks,
                       const SimulationObject::Create& create, bool again,
                       sunder_simulation* simulation);

}  // namespace sunder::c
