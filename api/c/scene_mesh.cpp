// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "c/scene.hpp"
#include "c/scene_words.hpp"
#include "c/structs.hpp"
#include "c/text.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/tissue_presets.hpp"

namespace {

using namespace sunder::c;

void require_mesh_rows(std::size_t size, std::size_t columns, const char* what) {
  const std::size_t most = static_cast<std::size_t>(std::numeric_limits<sunder::Index>::max());
  if (size > 0 && size % columns == 0 && size / columns <= most) return;
  throw Failure(SUNDER_ERROR_SIZE, std::string(what) + " has " + std::to_string(size) +
                                       " values; it must have " + std::to_string(columns) +
                                       " for each of 1 to 2^31 - 1 rows");
}

}  // namespace

extern "C" {

sunder_status sunder_scene_set_mesh(sunder_scene scene, const double* nodes, size_t nodes_size,
                                    const int32_t* tets, size_t tets_size,
                                    const int32_t* material_of, size_t material_of_size) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    require(nodes, "nodes");
    require(tets, "tets");
    require_mesh_rows(nodes_size, 3, "nodes");
    require_mesh_rows(tets_size, 4, "tets");
    const std::size_t count = tets_size / 4;
    if (material_of) {
      require_size(material_of_size, count, "material_of");
    } else {
      require_size(material_of_size, 0, "material_of (null)");
    }
    require_finite(nodes, nodes_size, "nodes");
    sunder::Mesh mesh;
    mesh.volumes = object.scene.mesh.volumes;
    mesh.nodes.resize(nodes_size / 3);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) mesh.nodes[n] = sunder::Vec3(nodes + 3 * n);
    mesh.tets.resize(count);
    for (std::size_t t = 0; t < count; ++t) std::copy_n(tets + 4 * t, 4, mesh.tets[t].begin());
    mesh.volume_of.assign(count, 0);
    if (material_of) mesh.volume_of.assign(material_of, material_of + count);
    object.scene.mesh = std::move(mesh);
  });
}

void sunder_material_init(sunder_material* material) {
  if (material) *material = sized<sunder_material>();
}

sunder_status sunder_preset_count(int32_t* count) {
  return guarded([&] {
    require(count, "count");
    *count = static_cast<int32_t>(sunder::tissue_presets().size());
  });
}

sunder_status sunder_preset_at(int32_t index, char* name, size_t capacity, size_t* length) {
  return guarded([&] {
    const auto all = sunder::preset_names();
    require_index(index, static_cast<std::int64_t>(all.size()), "preset");
    write_text(all[static_cast<std::size_t>(index)], name, capacity, length);
  });
}

sunder_status sunder_material_preset(const char* preset, sunder_material* material) {
  return guarded([&] {
    require(preset, "preset");
    auto filled = read_struct(material, sized<sunder_material>(), "material");
    const sunder::TissuePreset* found = sunder::find_preset(preset);
    if (!found) {
      std::string known;
      for (const std::string& name : sunder::preset_names())
        known += (known.empty() ? "" : ", ") + sunder::in_quotes(name);
      throw Failure(SUNDER_ERROR_VALUE,
                    "preset is " + sunder::in_quotes(preset) + "; allowed: " + known);
    }
    const sunder::Material of = found->material();
    filled.young = of.young;
    filled.poisson = of.poisson;
    filled.yield = of.yield.value_or(0.0);
    filled.density = of.density.value_or(0.0);
    filled.toughness = of.toughness.value_or(0.0);
    filled.energy = of.energy.value_or(0.0);
    write_struct(material, filled, "material");
  });
}

sunder_status sunder_scene_add_material(sunder_scene scene, const sunder_material* material,
                                        int32_t* index) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(material, sized<sunder_material>(), "material");
    require_finite(given.young, "young");
    require_finite(given.poisson, "poisson");
    require_finite(given.yield, "yield");
    require_finite(given.density, "density");
    require_finite(given.toughness, "toughness");
    require_finite(given.energy, "energy");
    const std::size_t number = object.materials.size();
    sunder::Material m{given.young, given.poisson,
                       {},          word<sunder::MaterialLaw>(given.law, "material", "law"),
                       {},          {},
                       {}};
    if (given.yield != 0) m.yield = given.yield;
    if (given.density != 0) m.density = given.density;
    if (given.toughness != 0) m.toughness = given.toughness;
    if (given.energy != 0) m.energy = given.energy;
    m.volume = word<sunder::MaterialVolume>(given.volume, "material", "volume");
    object.materials.push_back(m);
    object.scene.mesh.volumes.push_back(
        {given.name ? given.name : std::to_string(number), static_cast<int>(number)});
    if (index) *index = static_cast<int32_t>(number);
  });
}

}  // extern "C"
