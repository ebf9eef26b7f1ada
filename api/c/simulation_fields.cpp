// SPDX-License-Identifier: Apache-2.0
// Fields of the last solve, into the caller's arrays.
#include <algorithm>

#include "c/simulation.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace {

using namespace sunder::c;
using sunder::Index;
using sunder::Vec3;
using sunder::Voigt;

/// Checks a caller's array and fills it with body(object).
template <class T, class Size, class Body>
sunder_status read(sunder_simulation simulation, T* values, size_t given, Size size, Body body) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    const std::size_t wanted = size(object);
    require_size(given, wanted, "values");
    if (wanted > 0) require(values, "values");
    body(object);
  });
}

std::size_t nodes(const SimulationObject& object) { return object.problem().mesh().nodes.size(); }
std::size_t tets(const SimulationObject& object) { return object.problem().mesh().tets.size(); }
std::size_t instruments(const SimulationObject& object) {
  return object.problem().scene().instruments.size();
}

/// A number of every element's stress.
template <class Of>
void per_element(const SimulationObject& object, double* values, Of of) {
  const std::vector<Voigt> stress = object.simulation().stress();
  for (std::size_t e = 0; e < stress.size(); ++e) values[e] = of(static_cast<Index>(e), stress[e]);
}

}  // namespace

extern "C" {

sunder_status sunder_simulation_displacement(sunder_simulation simulation, double* values,
                                             size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 3 * nodes(object); },
      [&](SimulationObject& object) {
        if (object.solved()) {
          object.simulation().backend().read_displacement({values, size});
        } else {
          std::fill_n(values, size, 0.0);
        }
      });
}

sunder_status sunder_simulation_velocity(sunder_simulation simulation, double* values,
                                         size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 3 * nodes(object); },
      [&](SimulationObject& object) {
        require_motion(object, "a velocity");
        object.simulation().backend().read_velocity({values, size});
      });
}

sunder_status sunder_simulation_set_velocity(sunder_simulation simulation, const double* values,
                                             size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 3 * nodes(object); },
      [&](SimulationObject& object) {
        require_motion(object, "a velocity");
        require_finite(values, size, "values");
        object.simulation().backend().set_velocity({values, size});
      });
}

sunder_status sunder_simulation_stress(sunder_simulation simulation, double* values, size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 6 * tets(object); },
      [&](SimulationObject& object) {
        const std::vector<Voigt> stress = object.simulation().stress();
        for (std::size_t e = 0; e < stress.size(); ++e) {
          std::copy_n(stress[e].data(), 6, values + 6 * e);
        }
      });
}

sunder_status sunder_simulation_max_shear(sunder_simulation simulation, double* values,
                                          size_t size) {
  return read(simulation, values, size, tets, [&](SimulationObject& object) {
    per_element(object, values, [](Index, const Voigt& s) { return sunder::max_shear(s); });
  });
}

sunder_status sunder_simulation_yield_ratio(sunder_simulation simulation, double* values,
                                            size_t size) {
  return read(simulation, values, size, tets, [&](SimulationObject& object) {
    const sunder::Problem& problem = object.problem();
    const auto measure = sunder::strength_measure(problem.scene().fracture);
    const auto destroyed = object.simulation().backend().destroyed();
    per_element(object, values, [&](Index e, const Voigt& s) {
      if (!problem.breakable(e) || destroyed[static_cast<std::size_t>(e)]) return 0.0;
      return sunder::yield_measure(s, measure) / problem.yield(e);
    });
  });
}

sunder_status sunder_simulation_destroyed(sunder_simulation simulation, uint8_t* values,
                                          size_t size) {
  return read(simulation, values, size, tets, [&](SimulationObject& object) {
    const auto destroyed = object.simulation().backend().destroyed();
    std::copy(destroyed.begin(), destroyed.end(), values);
  });
}

sunder_status sunder_simulation_reactions(sunder_simulation simulation, double* values,
                                          size_t size) {
  return read(
      simulation, values, size, [](auto& object) { return 3 * instruments(object); },
      [&](SimulationObject& object) {
        std::fill_n(values, size, 0.0);
        if (!object.solved()) return;
        for (const Vec3& force : object.simulation().reactions()) {
          values = std::copy_n(force.data(), 3, values);
        }
      });
}

sunder_status sunder_simulation_support_reaction(sunder_simulation simulation, double* values,
                                                 size_t size) {
  return read(
      simulation, values, size, [](auto&) { return std::size_t{3}; },
      [&](SimulationObject& object) {
        if (!object.solved()) {
          throw Failure(SUNDER_ERROR_ORDER, "there is no support reaction before the first step");
        }
        const Vec3 force = object.simulation().support_reaction();
        std::copy_n(force.data(), 3, values);
      });
}

}  // extern "C"
