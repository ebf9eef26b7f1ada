// SPDX-License-Identifier: Apache-2.0
// What simulations of one intact body share.
#include "c/simulation_create.hpp"
#include "sunder/backends.hpp"

namespace {

using namespace sunder::c;

/// Never held by a call: any number of threads make simulations of it at once.
class BodiesObject final : public Object {
 public:
  static constexpr const char* kName = "set of bodies";

  explicit BodiesObject(std::size_t most) : prepared(sunder::prepared_bodies(most)) {}
  const std::shared_ptr<sunder::cpu_reference::PreparedBodies> prepared;
};

}  // namespace

extern "C" {

sunder_status sunder_bodies_create(int32_t most, sunder_bodies* bodies) {
  return guarded([&] {
    require(bodies, "bodies");
    if (most < 1) {
      throw Failure(SUNDER_ERROR_VALUE,
                    "most is " + std::to_string(most) + "; allowed is 1 or more");
    }
    *bodies =
        new_handle<sunder_bodies>(std::make_shared<BodiesObject>(static_cast<std::size_t>(most)));
  });
}

sunder_status sunder_bodies_destroy(sunder_bodies bodies) { return destroy<BodiesObject>(bodies); }

sunder_status sunder_simulation_create_of(sunder_scene scene, sunder_bodies bodies,
                                          const sunder_callbacks* callbacks,
                                          sunder_simulation* simulation) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto shared = find<BodiesObject>(bodies, BodiesObject::kName)->prepared;
    create_simulation(
        object, callbacks,
        [shared](std::shared_ptr<const sunder::Problem> problem, sunder::Needs needs,
                 const std::shared_ptr<sunder::PipelineCache>&) {
          return sunder::create_prepared_backend(std::move(problem), std::move(needs), shared);
        },
        true, simulation);
  });
}

}  // extern "C"
