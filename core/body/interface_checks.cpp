// SPDX-License-Identifier: Apache-2.0
#include "body/interface_checks.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "body/lay_interfaces.hpp"
#include "body/layer_geometry.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::fem {

std::string interface_name(const Scene& scene, std::size_t i) {
  const auto& between = scene.interfaces[i].between;
  return "interface " + std::to_string(i) + " (between " + in_quotes(between[0]) + " and " +
         in_quotes(between[1]) + ")";
}

bool is_laid(const Scene& scene, std::size_t i) {
  const Mesh& mesh = scene.mesh;
  const auto volume = std::ranges::find(mesh.volumes, interface_volume(i), &NamedVolume::name);
  if (volume == mesh.volumes.end()) return false;
  return std::ranges::find(mesh.volume_of, static_cast<Index>(volume - mesh.volumes.begin())) !=
         mesh.volume_of.end();
}

namespace {

void check_numbers_and_names(const Scene& scene, std::size_t i) {
  const Interface& interface = scene.interfaces[i];
  const std::string what = interface_name(scene, i);
  const auto positive = [&](const char* key, double value, const char* unit) {
    if (std::isfinite(value) && value > 0) return;
    throw InputError(InputFault::out_of_range, what + " has " + key + " = " + in_digits(value) +
                                                   "; it must be finite and above 0" + unit);
  };
  positive("strength", interface.strength, " MPa");
  positive("energy", interface.energy, " N/mm");
  positive("shear_ratio", interface.shear_ratio, "");
  std::vector<std::string> names;
  for (const NamedVolume& v : scene.mesh.volumes) names.push_back(v.name);
  for (const std::string& name : interface.between) {
    if (std::ranges::find(names, name) != names.end()) continue;
    throw InputError(InputFault::unknown_name, what + " names volume " + in_quotes(name) +
                                                   "; the mesh has " + name_list(names));
  }
  if (interface.between[0] == interface.between[1]) {
    throw InputError(InputFault::out_of_range,
                     what + " has the same volume on both sides; it needs two");
  }
  for (std::size_t j = 0; j < i; ++j) {
    auto a = interface.between, b = scene.interfaces[j].between;
    std::ranges::sort(a);
    std::ranges::sort(b);
    if (a != b) continue;
    throw InputError(InputFault::duplicate_name,
                     what + " lies where interface " + std::to_string(j) + " does");
  }
}

/// What speaks against interfaces in the scene.
void check_scene(const Scene& scene) {
  const auto refuse = [](const std::string& why) {
    throw InputError(InputFault::out_of_range, "[[interface]] " + why);
  };
  const FractureOptions& f = scene.fracture;
  if (f.model == FractureModel::b) {
    refuse(
        "does not go with model \"B\", which grows cracks through elements; take model \"A\" or "
        "\"P\"");
  }
  if (f.averaging > 0) {
    refuse(
        "does not go with fracture.averaging, which would mix its traction with the stress of the "
        "tissue beside it; leave averaging out");
  }
}

/// What a scene says of the layer, which is made by itself; and a volume of the mesh of its name
/// must be one.
void check_layer(const Scene& scene, std::size_t i) {
  const std::string name = interface_volume(i);
  if (!is_laid(scene, i)) {
    if (!scene.materials.contains(name)) return;
    throw InputError(InputFault::unknown_name,
                     "material " + in_quotes(name) + " names no volume of the mesh; the layer of " +
                         interface_name(scene, i) +
                         " follows from strength and energy, so leave it out");
  }
  const Mesh& mesh = scene.mesh;
  const auto& between = scene.interfaces[i].between;
  const auto first = nodes_of_volume(mesh, between[0]), second = nodes_of_volume(mesh, between[1]);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    if (mesh.volumes[static_cast<std::size_t>(mesh.volume_of[e])].name != name) continue;
    bool below = false, above = false, outside = false;
    for (Index n : mesh.tets[e]) {
      below = below || first[static_cast<std::size_t>(n)] != 0;
      above = above || first[static_cast<std::size_t>(n)] == 0;
      outside = outside || (first[static_cast<std::size_t>(n)] == 0 &&
                            second[static_cast<std::size_t>(n)] == 0);
    }
    if (below && above && !outside) continue;
    throw InputError(InputFault::duplicate_name,
                     "volume " + in_quotes(name) + " has the name of the layer of " +
                         interface_name(scene, i) + " and is none (element " + std::to_string(e) +
                         "); name it otherwise in the mesh");
  }
}

}  // namespace

void check_interfaces(const Scene& scene) {
  check_scene(scene);
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    check_numbers_and_names(scene, i);
    check_layer(scene, i);
  }
}

}  // namespace sunder::fem
