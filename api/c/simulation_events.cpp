// SPDX-License-Identifier: Apache-2.0
// What broke and why: records of destroyed elements, cracks, warnings.
#include <algorithm>

#include "c/simulation.hpp"
#include "c/structs.hpp"
#include "c/text.hpp"
#include "sunder/board_plane.hpp"

namespace {

using namespace sunder::c;
using sunder::Vec2;
using sunder::Vec3;

sunder_event to_event(const sunder::DestroyedElement& d, std::int32_t order) {
  auto event = sized<sunder_event>();
  event.order = order;
  event.step = d.step;
  event.event = d.event;
  event.element = d.element;
  event.lives = d.lives ? 1 : 0;
  event.cause = static_cast<std::int32_t>(d.cause);
  event.crack = d.crack;
  event.instrument = d.instrument;
  event.instrument_share = d.instrument_share;
  event.load_factor = d.load_factor;
  event.ratio = d.ratio.value_or(0.0);
  event.energy = d.energy.value_or(0.0);
  if (!d.sif) return event;
  const sunder::SifTerms& s = *d.sif;
  event.has_sif = 1;
  event.tip = s.tip;
  event.k = s.k;
  event.k_a = s.k_a;
  event.k_b = s.k_b;
  event.k_c = s.k_c;
  event.theta = s.theta;
  event.reach = s.reach;
  event.sigma0 = s.sigma0;
  event.beta = s.beta;
  event.a = s.a;
  event.b = s.b;
  event.k_1 = s.k_1.value_or(0.0);
  event.k_2 = s.k_2.value_or(0.0);
  event.toughness = s.toughness.value_or(0.0);
  event.advance = s.advance;
  return event;
}

sunder::BoardPlane plane_of(const SimulationObject& object) {
  const sunder::Problem& problem = object.problem();
  return sunder::board_plane(problem.mesh(), problem.scene().fracture.plane_normal);
}

void put(const Vec3& v, double* to) { std::copy_n(v.data(), 3, to); }

sunder_crack to_crack(const sunder::Crack& c, const sunder::BoardPlane& plane) {
  auto crack = sized<sunder_crack>();
  crack.id = c.id;
  crack.kind = c.kind == sunder::CrackKind::edge ? SUNDER_CRACK_EDGE : SUNDER_CRACK_INTERNAL;
  crack.tip_count = static_cast<std::int32_t>(c.tips.size());
  crack.path_count = static_cast<std::int32_t>(c.path.size());
  crack.element_count = static_cast<std::int32_t>(c.elements.size());
  if (c.mouth) put(plane.lift(*c.mouth), crack.mouth);
  for (std::size_t t = 0; t < std::min<std::size_t>(c.tips.size(), 2); ++t) {
    crack.tip_ended[t] = c.tips[t].ended ? 1 : 0;
    put(plane.lift(c.tips[t].position), crack.tips[t]);
    put(plane.lift_direction(c.tips[t].direction), crack.directions[t]);
  }
  crack.length = c.length;
  return crack;
}

sunder_tip to_tip(const sunder::TipState& t) {
  auto tip = sized<sunder_tip>();
  tip.crack = t.crack;
  tip.tip = t.tip;
  tip.ended = t.ended ? 1 : 0;
  tip.plane_strain = t.toughness_state == "plane strain" ? 1 : 0;
  put(t.position, tip.position);
  const auto take = [&tip](const std::optional<double>& from, double& to, std::int32_t bit) {
    if (from) tip.known |= bit;
    to = from.value_or(0.0);
  };
  take(t.k, tip.k, SUNDER_TIP_K);
  take(t.theta, tip.theta, SUNDER_TIP_THETA);
  take(t.k_1, tip.k_1, SUNDER_TIP_MODES);
  take(t.k_2, tip.k_2, SUNDER_TIP_MODES);
  take(t.k_3, tip.k_3, SUNDER_TIP_MODES);
  take(t.j, tip.j, SUNDER_TIP_J);
  take(t.toughness, tip.toughness, SUNDER_TIP_TOUGHNESS);
  t.field_note.copy(tip.field_note, sizeof tip.field_note - 1);
  return tip;
}

const sunder::Crack& crack_of(const SimulationObject& object, std::int32_t index) {
  const auto& cracks = object.simulation().cracks();
  require_index(index, static_cast<std::int64_t>(cracks.size()), "crack");
  return cracks[static_cast<std::size_t>(index)];
}

/// A number of things, for a caller's counter.
template <class Of>
sunder_status count_of(sunder_simulation simulation, std::int32_t* count, Of of) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(count, "count");
    *count = static_cast<std::int32_t>(of(object));
  });
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_event_count(sunder_simulation simulation, int32_t* count) {
  return count_of(simulation, count, [](auto& o) { return o.simulation().destroyed().size(); });
}

sunder_status sunder_simulation_event_at(sunder_simulation simulation, int32_t index,
                                         sunder_event* event) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const auto& all = object.simulation().destroyed();
    require_index(index, static_cast<std::int64_t>(all.size()), "event");
    write_struct(event, to_event(all[static_cast<std::size_t>(index)], index), "event");
  });
}

sunder_status sunder_simulation_crack_count(sunder_simulation simulation, int32_t* count) {
  return count_of(simulation, count, [](auto& o) { return o.simulation().cracks().size(); });
}

sunder_status sunder_simulation_crack_at(sunder_simulation simulation, int32_t index,
                                         sunder_crack* crack) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    write_struct(crack, to_crack(crack_of(object, index), plane_of(object)), "crack");
  });
}

sunder_status sunder_simulation_crack_path(sunder_simulation simulation, int32_t index,
                                           double* values, size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const sunder::Crack& crack = crack_of(object, index);
    require_size(size, 3 * crack.path.size(), "values");
    require(values, "values");
    const sunder::BoardPlane plane = plane_of(object);
    for (std::size_t p = 0; p < crack.path.size(); ++p) {
      put(plane.lift(crack.path[p]), values + 3 * p);
    }
  });
}

sunder_status sunder_simulation_crack_elements(sunder_simulation simulation, int32_t index,
                                               int32_t* values, size_t size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const sunder::Crack& crack = crack_of(object, index);
    require_size(size, crack.elements.size(), "values");
    require(values, "values");
    std::copy(crack.elements.begin(), crack.elements.end(), values);
  });
}

sunder_status sunder_simulation_measure_tips(sunder_simulation simulation, int32_t* count) {
  return count_of(simulation, count, [](auto& object) {
    object.tips = object.simulation().tips();
    return object.tips.size();
  });
}

sunder_status sunder_simulation_tip_at(sunder_simulation simulation, int32_t index,
                                       sunder_tip* tip) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require_index(index, static_cast<std::int64_t>(object.tips.size()), "tip");
    write_struct(tip, to_tip(object.tips[static_cast<std::size_t>(index)]), "tip");
  });
}

sunder_status sunder_simulation_warning_count(sunder_simulation simulation, int32_t* count) {
  return count_of(simulation, count, [](auto& o) { return o.warnings().size(); });
}

sunder_status sunder_simulation_warning_at(sunder_simulation simulation, int32_t index, char* text,
                                           size_t capacity, size_t* length) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const auto warnings = object.warnings();
    require_index(index, static_cast<std::int64_t>(warnings.size()), "warning");
    write_text(warnings[static_cast<std::size_t>(index)], text, capacity, length);
  });
}

}  // extern "C"
