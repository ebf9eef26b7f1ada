// SPDX-License-Identifier: Apache-2.0
// What a host draws: where live tissue ends, and a mesh of its own carried by the body.
#include <algorithm>

#include "c/simulation.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;
using sunder::Vec3;

sunder::Surface& surface_of(SimulationObject& object) {
  if (object.surface) return *object.surface;
  throw Failure(SUNDER_ERROR_ORDER, "the surface has not been asked for yet");
}

sunder::Skin& skin_of(SimulationObject& object) {
  if (object.skin) return *object.skin;
  throw Failure(SUNDER_ERROR_ORDER, "the simulation was given no skin");
}

sunder_triangle to_triangle(const sunder::Surface& surface, std::uint32_t place) {
  sunder_triangle triangle{static_cast<std::int32_t>(place), {-1, -1, -1}, -1, -1, 0};
  if (place >= surface.triangles().size()) return triangle;  // gone
  const sunder::SurfaceTriangle& from = surface.triangles()[place];
  std::ranges::copy(from.nodes, triangle.nodes);
  triangle.element = from.element;
  triangle.piece = from.piece;
  triangle.opened = from.opened ? 1 : 0;
  return triangle;
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_surface(sunder_simulation simulation, sunder_surface* surface) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    static_cast<void>(stated_size(surface, "surface"));
    write_struct(surface, to_c(object.follow_surface()), "surface");
  });
}

sunder_status sunder_simulation_surface_changes(sunder_simulation simulation, uint64_t since,
                                                sunder_triangle* triangles, size_t capacity,
                                                size_t* count) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(count, "count");
    const sunder::Surface& surface = surface_of(object);
    const std::vector<std::uint32_t> places = surface.changed_since(since);
    *count = places.size();
    if (!triangles && capacity == 0) return;
    if (!places.empty()) require(triangles, "triangles");
    if (capacity < places.size()) {
      throw Failure(SUNDER_ERROR_SIZE, "triangles has room for " + std::to_string(capacity) +
                                           "; there are " + std::to_string(places.size()));
    }
    for (std::uint32_t place : places) *triangles++ = to_triangle(surface, place);
  });
}

sunder_status sunder_simulation_surface_points(sunder_simulation simulation, float* places,
                                               float* normals, size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const sunder::Surface& surface = surface_of(object);
    require_size(size, 3 * surface.node_count(), "places");
    surface.points({places, places ? size : 0}, {normals, normals ? size : 0});
  });
}

sunder_status sunder_simulation_set_skin(sunder_simulation simulation, const double* vertices,
                                         size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(vertices, "vertices");
    if (size % 3 != 0) {
      throw Failure(SUNDER_ERROR_SIZE, "vertices has " + std::to_string(size) +
                                           " values; it must have 3 for each vertex");
    }
    require_rows(size / 3, "vertices");
    require_finite(vertices, size, "vertices");
    std::vector<Vec3> at(size / 3);
    for (std::size_t v = 0; v < at.size(); ++v) at[v] = Vec3(vertices + 3 * v);
    object.skin = std::make_unique<sunder::Skin>(object.simulation(), at);
    ++object.skins;
  });
}

sunder_status sunder_simulation_skin(sunder_simulation simulation, float* places, size_t size,
                                     uint8_t* lives) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const sunder::Skin& skin = skin_of(object);
    require_size(size, 3 * skin.size(), "places");
    if (size > 0) require(places, "places");
    skin.places({places, size}, {lives, lives ? skin.size() : 0});
  });
}

}  // extern "C"
