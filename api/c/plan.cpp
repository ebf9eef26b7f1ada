// SPDX-License-Identifier: Apache-2.0
// What a scene needs, before it runs.
#include "c/engine.hpp"
#include "c/scene.hpp"
#include "c/text.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"

namespace {

using namespace sunder::c;

class PlanObject final : public Object {
 public:
  static constexpr const char* kName = "plan";

  sunder_engine engine{};
  std::vector<sunder::BufferPlan> buffers;
  std::vector<std::string> left_out;
};

}  // namespace

extern "C" {

sunder_status sunder_plan_create(sunder_scene scene, sunder_plan* plan) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    require(plan, "plan");
    const auto problem = object.problem();
    auto made = std::make_shared<PlanObject>();
    const auto created = sunder::create_backend(problem, sunder::needs_of(*problem));
    made->left_out = created.backend->needs().left_out;
    made->engine = describe(*problem, created.backend->info());
    made->buffers = created.backend->buffers();
    *plan = new_handle<sunder_plan>(std::move(made));
  });
}

sunder_status sunder_plan_destroy(sunder_plan plan) { return destroy<PlanObject>(plan); }

sunder_status sunder_plan_engine(sunder_plan plan, sunder_engine* engine) {
  return call<PlanObject>(
      plan, [&](PlanObject& object) { write_struct(engine, object.engine, "engine"); });
}

sunder_status sunder_plan_counts(sunder_plan plan, int32_t* buffers, int32_t* left_out) {
  return call<PlanObject>(plan, [&](PlanObject& object) {
    if (buffers) *buffers = static_cast<int32_t>(object.buffers.size());
    if (left_out) *left_out = static_cast<int32_t>(object.left_out.size());
  });
}

sunder_status sunder_plan_buffer(sunder_plan plan, int32_t index, uint64_t* bytes, char* name,
                                 size_t capacity, size_t* length) {
  return call<PlanObject>(plan, [&](PlanObject& object) {
    require_index(index, static_cast<std::int64_t>(object.buffers.size()), "buffer");
    const auto& buffer = object.buffers[static_cast<std::size_t>(index)];
    write_text(buffer.name, name, capacity, length);
    if (bytes) *bytes = buffer.bytes;
  });
}

sunder_status sunder_plan_left_out(sunder_plan plan, int32_t index, char* text, size_t capacity,
                                   size_t* length) {
  return call<PlanObject>(plan, [&](PlanObject& object) {
    require_index(index, static_cast<std::int64_t>(object.left_out.size()), "left_out");
    write_text(object.left_out[static_cast<std::size_t>(index)], text, capacity, length);
  });
}

}  // extern "C"
