// SPDX-License-Identifier: Apache-2.0
// Fields of the last solve, into the caller's arrays.
#include <algorithm>
#include <iterator>
#include <span>

#include "c/simulation.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace {

using namespace sunder::c;
using sunder::Index;
using sunder::Vec3;
using sunder::Voigt;

std::size_t nodes(const SimulationObject& object) { return object.problem().mesh().nodes.size(); }
std::size_t tets(const SimulationObject& object) { return object.problem().mesh().tets.size(); }
std::size_t three_a_node(const SimulationObject& object) { return 3 * nodes(object); }
std::size_t six_a_tet(const SimulationObject& object) { return 6 * tets(object); }
std::size_t instruments(const SimulationObject& object) {
  return object.problem().scene().instruments.size();
}

void fill_displacement(SimulationObject& object, std::span<double> values) {
  if (object.solved()) {
    object.simulation().backend().read_displacement(values);
  } else {
    std::ranges::fill(values, 0.0);
  }
}

void fill_velocity(SimulationObject& object, std::span<double> values) {
  require_motion(object, "a velocity");
  object.simulation().backend().read_velocity(values);
}

void fill_stress(SimulationObject& object, std::span<double> values) {
  const std::vector<Voigt> stress = object.simulation().stress();
  for (std::size_t e = 0; e < stress.size(); ++e) {
    std::copy_n(stress[e].data(), 6, values.data() + 6 * e);
  }
}

/// A number of every element's stress.
template <class Of>
void per_element(const SimulationObject& object, std::span<double> values, Of of) {
  const std::vector<Voigt> stress = object.simulation().stress();
  for (std::size_t e = 0; e < stress.size(); ++e) values[e] = of(static_cast<Index>(e), stress[e]);
}

void fill_max_shear(SimulationObject& object, std::span<double> values) {
  per_element(object, values, [](Index, const Voigt& s) { return sunder::max_shear(s); });
}

void fill_yield_ratio(SimulationObject& object, std::span<double> values) {
  const sunder::Problem& problem = object.problem();
  const auto measure = sunder::strength_measure(problem.scene().fracture);
  const auto destroyed = object.simulation().backend().destroyed();
  per_element(object, values, [&](Index e, const Voigt& s) {
    if (!problem.breakable(e) || destroyed[static_cast<std::size_t>(e)]) return 0.0;
    return problem.yield_ratio(e, s, measure);
  });
}

void fill_destroyed(SimulationObject& object, std::span<std::uint8_t> values) {
  std::ranges::copy(object.simulation().backend().destroyed(), values.begin());
}

struct Field {
  std::size_t (*size)(const SimulationObject&);
  void (*fill)(SimulationObject&, std::span<double>);
};

/// By sunder_field.
constexpr Field kFields[] = {{three_a_node, fill_displacement},
                             {three_a_node, fill_velocity},
                             {six_a_tet, fill_stress},
                             {tets, fill_max_shear},
                             {tets, fill_yield_ratio}};

/// Checks a caller's array and fills it with fill(object, values).
template <class T, class Size, class Fill>
sunder_status read(sunder_simulation simulation, T* values, size_t given, Size size, Fill fill) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const std::size_t wanted = size(object);
    require_size(given, wanted, "values");
    if (wanted > 0) require(values, "values");
    fill(object, std::span<T>(values, given));
  });
}

/// Fills memory of the object's own, which stays where it is, and tells where.
template <class T, class Fill>
void lend(SimulationObject& object, std::vector<T>& room, std::size_t wanted, Fill fill,
          const T** values, size_t* size) {
  room.resize(wanted);
  fill(object, std::span<T>(room));
  *values = room.data();
  *size = wanted;
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_displacement(sunder_simulation simulation, double* values,
                                             size_t size) {
  return read(simulation, values, size, three_a_node, fill_displacement);
}

sunder_status sunder_simulation_velocity(sunder_simulation simulation, double* values,
                                         size_t size) {
  return read(simulation, values, size, three_a_node, fill_velocity);
}

sunder_status sunder_simulation_set_velocity(sunder_simulation simulation, const double* values,
                                             size_t size) {
  return read(simulation, values, size, three_a_node,
              [](SimulationObject& object, std::span<const double> velocity) {
                require_motion(object, "a velocity");
                require_finite(velocity.data(), velocity.size(), "values");
                object.simulation().backend().set_velocity(velocity);
              });
}

sunder_status sunder_simulation_stress(sunder_simulation simulation, double* values, size_t size) {
  return read(simulation, values, size, six_a_tet, fill_stress);
}

sunder_status sunder_simulation_max_shear(sunder_simulation simulation, double* values,
                                          size_t size) {
  return read(simulation, values, size, tets, fill_max_shear);
}

sunder_status sunder_simulation_yield_ratio(sunder_simulation simulation, double* values,
                                            size_t size) {
  return read(simulation, values, size, tets, fill_yield_ratio);
}

sunder_status sunder_simulation_destroyed(sunder_simulation simulation, uint8_t* values,
                                          size_t size) {
  return read(simulation, values, size, tets, fill_destroyed);
}

sunder_status sunder_simulation_reactions(sunder_simulation simulation, double* values,
                                          size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 3 * instruments(object); },
      [](SimulationObject& object, std::span<double> all) {
        std::ranges::fill(all, 0.0);
        if (!object.solved()) return;
        double* at = all.data();
        for (const Vec3& force : object.simulation().reactions()) {
          at = std::copy_n(force.data(), 3, at);
        }
      });
}

sunder_status sunder_simulation_support_reaction(sunder_simulation simulation, double* values,
                                                 size_t size) {
  return read(
      simulation, values, size, [](auto&) { return std::size_t{3}; },
      [](SimulationObject& object, std::span<double> three) {
        if (!object.solved()) {
          throw Failure(SUNDER_ERROR_ORDER, "there is no support reaction before the first step");
        }
        const Vec3 force = object.simulation().support_reaction();
        std::copy_n(force.data(), 3, three.data());
      });
}

sunder_status sunder_simulation_lend(sunder_simulation simulation, sunder_field field,
                                     const double** values, size_t* size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(values, "values");
    require(size, "size");
    require_index(field, std::ssize(kFields), "field");
    const Field& of = kFields[field];
    lend(object, object.lent[static_cast<std::size_t>(field)], of.size(object), of.fill, values,
         size);
  });
}

sunder_status sunder_simulation_lend_destroyed(sunder_simulation simulation, const uint8_t** values,
                                               size_t* size) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(values, "values");
    require(size, "size");
    lend(object, object.lent_destroyed, tets(object), fill_destroyed, values, size);
  });
}

}  // extern "C"
