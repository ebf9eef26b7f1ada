// SPDX-License-Identifier: Apache-2.0
// What a host does to a live body, and taking it back.
#include <cstring>
#include <span>

#include "c/places.hpp"
#include "c/simulation.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;
using sunder::Index;
using sunder::Vec3;

void put(std::int32_t* to, std::int32_t value) {
  if (to) *to = value;
}

sunder::Mark& mark_of(SimulationObject& object, std::int32_t mark) {
  const auto found = object.marks.find(mark);
  if (found != object.marks.end()) return found->second;
  throw Failure(SUNDER_ERROR_VALUE, "there is no mark " + std::to_string(mark));
}

void require_count(std::int32_t actions) {
  if (actions >= 1) return;
  throw Failure(SUNDER_ERROR_VALUE,
                "actions = " + std::to_string(actions) + "; it must be at least 1");
}

/// Does something with a caller's list of elements.
template <class Do>
sunder_status with_elements(sunder_simulation simulation, const std::int32_t* elements,
                            std::size_t count, Do act) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    if (count > 0) require(elements, "elements");
    require_rows(count, "elements");
    act(object.simulation(), std::span<const Index>(elements, count));
  });
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_warm_up(sunder_simulation simulation) {
  return call<SimulationObject>(simulation,
                                [&](SimulationObject& object) { object.simulation().warm_up(); });
}

sunder_status sunder_simulation_remove(sunder_simulation simulation, const int32_t* elements,
                                       size_t count) {
  return with_elements(simulation, elements, count, [](auto& of, auto all) { of.remove(all); });
}

sunder_status sunder_simulation_cut(sunder_simulation simulation, const double* swept, size_t size,
                                    int32_t* removed) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(swept, "swept");
    if (size % 9 != 0) {
      throw Failure(SUNDER_ERROR_SIZE, "swept has " + std::to_string(size) +
                                           " values; it must have 9 for each triangle");
    }
    require_rows(size / 9, "swept");
    require_finite(swept, size, "swept");
    std::vector<std::array<Vec3, 3>> triangles(size / 9);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t p = 0; p < 3; ++p) triangles[t][p] = Vec3(swept + 9 * t + 3 * p);
    }
    put(removed, object.simulation().cut(triangles));
  });
}

sunder_status sunder_simulation_prepare(sunder_simulation simulation, const int32_t* elements,
                                        size_t count) {
  return with_elements(simulation, elements, count, [](auto& of, auto all) { of.prepare(all); });
}

sunder_status sunder_simulation_prepare_near(sunder_simulation simulation, const double near[3],
                                             double radius, int32_t* count) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    put(count, object.simulation().prepare(to_place(near, "near"), to_radius(radius)));
  });
}

sunder_status sunder_simulation_keep_history(sunder_simulation simulation, int32_t quick) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    if (quick < 0) {
      throw Failure(SUNDER_ERROR_VALUE, "quick = " + std::to_string(quick) + " is below 0");
    }
    object.keep_history(quick);
  });
}

sunder_status sunder_simulation_history(sunder_simulation simulation, int32_t* undos,
                                        int32_t* redos) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    put(undos, object.simulation().undos());
    put(redos, object.simulation().redos());
  });
}

sunder_status sunder_simulation_undo(sunder_simulation simulation, int32_t actions, int32_t* events,
                                     int32_t* replayed) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_count(actions);
    const sunder::Travel travel = object.simulation().undo(actions);
    put(events, travel.events);
    put(replayed, travel.replayed ? 1 : 0);
  });
}

sunder_status sunder_simulation_redo(sunder_simulation simulation, int32_t actions,
                                     int32_t* events) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_count(actions);
    put(events, object.simulation().redo(actions).events);
  });
}

sunder_status sunder_simulation_save(sunder_simulation simulation, int32_t* mark) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(mark, "mark");
    object.marks[object.last_mark + 1] = object.simulation().save();
    *mark = ++object.last_mark;
  });
}

sunder_status sunder_simulation_restore(sunder_simulation simulation, int32_t mark,
                                        int32_t* replayed) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const sunder::Travel travel = object.simulation().restore(mark_of(object, mark));
    put(replayed, travel.replayed ? 1 : 0);
  });
}

sunder_status sunder_simulation_forget(sunder_simulation simulation, int32_t mark) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    mark_of(object, mark);
    object.marks.erase(mark);
  });
}

sunder_status sunder_simulation_store(sunder_simulation simulation, void* bytes, size_t capacity,
                                      size_t* length) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(length, "length");
    const std::vector<std::uint8_t> all = object.simulation().store();
    *length = all.size();
    if (!bytes && capacity == 0) return;
    require(bytes, "bytes");
    if (capacity < all.size()) {
      throw Failure(SUNDER_ERROR_SIZE, "bytes has room for " + std::to_string(capacity) +
                                           "; there are " + std::to_string(all.size()));
    }
    std::memcpy(bytes, all.data(), all.size());
  });
}

sunder_status sunder_simulation_load(sunder_simulation simulation, const void* bytes,
                                     size_t length) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(bytes, "bytes");
    object.simulation().load({static_cast<const std::uint8_t*>(bytes), length});
  });
}

}  // extern "C"
