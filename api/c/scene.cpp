// SPDX-License-Identifier: Apache-2.0
#include "c/scene.hpp"

#include <limits>

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

}  // namespace

std::shared_ptr<const Problem> SceneObject::problem() const {
  Scene complete = scene;
  complete.mesh.fields = fields;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    complete.materials[scene.mesh.volumes[m].name] = materials[m];
  }
  return std::make_shared<const Problem>(std::move(complete));
}

NodeSelection to_nodes(const sunder_selection& selection, const char* what) {
  switch (choice<int>(selection.kind, 3, "selection kind")) {
    case SUNDER_SELECT_IDS:
      return to_ids(selection, what);
    case SUNDER_SELECT_BOX:
      return to_box(selection, what);
    default:
      return to_ball(selection, what);
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
