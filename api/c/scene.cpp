// SPDX-License-Identifier: Apache-2.0
#include "c/scene.hpp"

#include <algorithm>
#include <limits>

#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::c {
namespace {

std::vector<Index> to_ids(const sunder_selection& selection, const char* what) {
  if (selection.id_count == 0) return {};
  require(selection.ids, (std::string(what) + ": ids").c_str());
  if (selection.id_count > static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    throw Failure(SUNDER_ERROR_SIZE, std::string(what) + ": id_count exceeds 32 bits");
  }
  return {selection.ids, selection.ids + selection.id_count};
}

SurfaceName keep_faces(SceneObject& object, const sunder_selection& selection, const char* what) {
  const std::vector<Index> ids = to_ids(selection, what);
  if (ids.size() % 3 != 0) {
    throw Failure(SUNDER_ERROR_SIZE, std::string(what) +
                                         ": id_count = " + std::to_string(ids.size()) +
                                         "; it must be 3 for each face");
  }
  NamedSurface surface;
  surface.name = std::string(what) + " faces " + std::to_string(object.surfaces.size());
  surface.triangles.resize(ids.size() / 3);
  for (std::size_t i = 0; i < ids.size(); ++i) surface.triangles[i / 3][i % 3] = ids[i];
  object.surfaces.push_back(std::move(surface));
  return {object.surfaces.back().name};
}

Box to_box(const sunder_selection& s, const char* what) {
  require_finite(s.min, 3, (std::string(what) + ": min").c_str());
  require_finite(s.max, 3, (std::string(what) + ": max").c_str());
  return {Vec3(s.min), Vec3(s.max)};
}

Ball to_ball(const sunder_selection& s, const char* what) {
  require_finite(s.min, 3, (std::string(what) + ": min").c_str());
  require_finite(s.radius, (std::string(what) + ": radius").c_str());
  return {Vec3(s.min), s.radius};
}

/// The elements that an interface brings are a volume of this name, as result files have them.
void require_free_names(const Scene& scene) {
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const std::string taken = "interface-" + std::to_string(i);
    if (std::ranges::find(scene.mesh.volumes, taken, &NamedVolume::name) ==
        scene.mesh.volumes.end()) {
      continue;
    }
    throw InputError(InputFault::duplicate_name,
                     "scene: material " + in_quotes(taken) + " has the name of what interface " +
                         std::to_string(i) + " is made of; name it otherwise");
  }
}

}  // namespace

std::shared_ptr<const Problem> SceneObject::problem() const {
  require_free_names(scene);
  Scene complete = scene;
  complete.mesh.fields = fields;
  complete.mesh.surfaces = surfaces;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    complete.materials[scene.mesh.volumes[m].name] = materials[m];
  }
  return std::make_shared<const Problem>(std::move(complete));
}

NodeSelection to_nodes(SceneObject& object, const sunder_selection& selection, const char* what) {
  switch (choice<int>(selection.kind, 4, "selection kind")) {
    case SUNDER_SELECT_IDS:
      return to_ids(selection, what);
    case SUNDER_SELECT_BOX:
      return to_box(selection, what);
    case SUNDER_SELECT_BALL:
      return to_ball(selection, what);
    default:
      return keep_faces(object, selection, what);
  }
}

ElementSelection to_elements(const sunder_selection& selection, const char* what) {
  if (choice<int>(selection.kind, 2, "selection kind of elements") == SUNDER_SELECT_IDS) {
    return to_ids(selection, what);
  }
  return to_box(selection, what);
}

}  // namespace sunder::c

extern "C" {

sunder_status sunder_scene_create(sunder_scene* scene) {
  using namespace sunder::c;
  return guarded([&] {
    require(scene, "scene");
    auto object = std::make_shared<SceneObject>();
    object->scene.source = "scene";
    *scene = new_handle<sunder_scene>(std::move(object));
  });
}

sunder_status sunder_scene_destroy(sunder_scene scene) {
  return sunder::c::destroy<sunder::c::SceneObject>(scene);
}

}  // extern "C"
