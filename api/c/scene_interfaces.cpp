// SPDX-License-Identifier: Apache-2.0
// Interfaces between a scene's materials.
#include "c/scene.hpp"

extern "C" {

sunder_status sunder_scene_add_interface(sunder_scene scene, int32_t first_material,
                                         int32_t second_material, double strength, double energy,
                                         double shear_ratio) {
  using namespace sunder::c;
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto& volumes = object.scene.mesh.volumes;
    const auto name = [&](std::int32_t material) {
      require_index(material, static_cast<std::int64_t>(volumes.size()), "material");
      return volumes[static_cast<std::size_t>(material)].name;
    };
    sunder::Interface added;
    added.between = {name(first_material), name(second_material)};
    require_finite(strength, "strength");
    require_finite(energy, "energy");
    require_finite(shear_ratio, "shear_ratio");
    added.strength = strength;
    added.energy = energy;
    added.shear_ratio = shear_ratio;
    object.scene.interfaces.push_back(std::move(added));
  });
}

}  // extern "C"
