// SPDX-License-Identifier: Apache-2.0
// Fibres of a scene's materials.
#include <string>

#include "c/scene.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;
using sunder::Vec3;

/// 0 is not given.
std::optional<double> given_number(double value, const char* what) {
  require_finite(value, what);
  return value != 0 ? std::optional(value) : std::nullopt;
}

/// Vectors by element, under the name that the mesh has them by.
sunder::FieldName keep_field(SceneObject& object, std::int32_t material,
                             const sunder_fibres& given) {
  require(given.field, "field");
  if (given.field_size == 0 || given.field_size % 3 != 0) {
    throw Failure(SUNDER_ERROR_SIZE, "field_size = " + std::to_string(given.field_size) +
                                         "; it must be 3 numbers for each element");
  }
  require_finite(given.field, given.field_size, "field");
  std::vector<Vec3> vectors(given.field_size / 3);
  for (std::size_t e = 0; e < vectors.size(); ++e) vectors[e] = Vec3(given.field + 3 * e);
  const std::size_t family = object.materials[static_cast<std::size_t>(material)].fibres.size();
  std::string name = "fibres " + std::to_string(material) + "." + std::to_string(family);
  object.fields[name] = std::move(vectors);
  return {std::move(name)};
}

sunder::Fibres to_fibres(SceneObject& object, std::int32_t material, const sunder_fibres& given) {
  sunder::Fibres fibres;
  fibres.k1 = given_number(given.k1, "k1");
  fibres.k2 = given_number(given.k2, "k2");
  if (fibres.k1 && !fibres.k2) fibres.k2 = 0.0;
  require_finite(given.dispersion, "dispersion");
  fibres.dispersion = given.dispersion;
  fibres.young_along = given_number(given.young_along, "young_along");
  fibres.poisson_along = given_number(given.poisson_along, "poisson_along");
  if (fibres.young_along && !fibres.poisson_along) fibres.poisson_along = 0.0;
  fibres.shear_along = given_number(given.shear_along, "shear_along");
  fibres.yield_across = given_number(given.yield_across, "yield_across");
  fibres.toughness_across = given_number(given.toughness_across, "toughness_across");
  fibres.energy_across = given_number(given.energy_across, "energy_across");
  switch (choice<int>(given.run, 3, "run of fibres")) {
    case SUNDER_FIBRES_STRAIGHT:
      require_finite(given.direction, 3, "direction");
      fibres.direction = Vec3(given.direction);
      break;
    case SUNDER_FIBRES_AROUND:
      require_finite(given.direction, 3, "direction");
      require_finite(given.point, 3, "point");
      fibres.direction = sunder::AroundAxis{Vec3(given.point), Vec3(given.direction)};
      break;
    default:
      fibres.direction = keep_field(object, material, given);  // nothing is refused after it
  }
  return fibres;
}

}  // namespace

extern "C" {

void sunder_fibres_init(sunder_fibres* fibres) {
  if (fibres) *fibres = sized<sunder_fibres>();
}

sunder_status sunder_scene_add_fibres(sunder_scene scene, int32_t material,
                                      const sunder_fibres* fibres) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(fibres, sized<sunder_fibres>(), "fibres");
    require_index(material, static_cast<std::int64_t>(object.materials.size()), "material");
    auto family = to_fibres(object, material, given);
    object.materials[static_cast<std::size_t>(material)].fibres.push_back(std::move(family));
  });
}

}  // extern "C"
