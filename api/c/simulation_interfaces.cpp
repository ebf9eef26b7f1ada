// SPDX-License-Identifier: Apache-2.0
// Interfaces of a simulation's body, and how far they have parted.
#include <algorithm>

#include "c/simulation.hpp"
#include "c/structs.hpp"
#include "sunder/parted_interfaces.hpp"

namespace {

using namespace sunder::c;

std::int32_t interface_count(const SimulationObject& object) {
  return static_cast<std::int32_t>(object.problem().scene().interfaces.size());
}

/// A material of the host's by its volume's name.
std::int32_t material_of(const sunder::Mesh& mesh, const std::string& volume) {
  const auto at = std::ranges::find(mesh.volumes, volume, &sunder::NamedVolume::name);
  return static_cast<std::int32_t>(at - mesh.volumes.begin());
}

sunder_interface to_interface(const SimulationObject& object, std::size_t i) {
  const sunder::Problem& problem = object.problem();
  const sunder::Mesh& mesh = problem.mesh();
  const sunder::Interface& of = problem.scene().interfaces[i];
  const sunder::Interfaces& all = *problem.interfaces();
  const sunder::InterfaceLayer& layer = all.layers()[i];
  const auto parted = sunder::parted_interfaces(all, object.simulation().destroyed())[i];
  auto state = sized<sunder_interface>();
  for (std::size_t side = 0; side < 2; ++side) {
    state.materials[side] = material_of(mesh, of.between[side]);
  }
  state.first_element = static_cast<std::int32_t>(std::ranges::find(mesh.volume_of, layer.volume) -
                                                  mesh.volume_of.begin());
  state.element_count = static_cast<std::int32_t>(std::ranges::count(mesh.volume_of, layer.volume));
  state.strength = of.strength;
  state.energy = of.energy;
  state.shear_ratio = of.shear_ratio;
  state.stiffness = layer.mu / layer.thickness;
  state.opening = layer.opening;
  state.thickness = layer.thickness;
  state.area = layer.area;
  state.parted = parted.area;
  state.spent = parted.energy;
  return state;
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_interface_count(sunder_simulation simulation, int32_t* count) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(count, "count");
    *count = interface_count(object);
  });
}

sunder_status sunder_simulation_interface_at(sunder_simulation simulation, int32_t index,
                                             sunder_interface* state) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_index(index, interface_count(object), "interface");
    write_struct(state, to_interface(object, static_cast<std::size_t>(index)), "interface");
  });
}

}  // extern "C"
