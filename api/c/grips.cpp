// SPDX-License-Identifier: Apache-2.0
// Forces of the grips between frames, for a thread of their own.
#include <algorithm>
#include <cmath>

#include "c/simulation.hpp"
#include "sunder/instrument_forces.hpp"

namespace sunder::c {
namespace {

class GripsObject final : public Object {
 public:
  static constexpr const char* kName = "grips";

  GripsObject(const Problem& problem, std::shared_ptr<InstrumentForces> block)
      : block_(std::move(block)), instruments_(problem.scene().instruments.size()) {
    const auto gripped = problem.gripped_dofs();
    place_.resize(gripped.size());
    displacement_.resize(gripped.size());
    force_.resize(gripped.size());
    for (std::size_t i = 0; i < instruments_; ++i) {
      const auto* grip = std::get_if<Grip>(&problem.scene().instruments[i].action);
      if (!grip) continue;
      for (Index n : problem.instrument_nodes()[i].nodes) {
        for (int axis = 0; axis < 3; ++axis) {
          if (!grip->axes.has(axis)) continue;
          const Index d = problem.dof(n, axis);
          const auto g = std::lower_bound(gripped.begin(), gripped.end(), d) - gripped.begin();
          place_[static_cast<std::size_t>(g)] = 3 * i + static_cast<std::size_t>(axis);
        }
      }
    }
  }

  [[nodiscard]] std::size_t size() const { return 3 * instruments_; }

  /// False: there was no frame yet, or the displacements are not finite.
  [[nodiscard]] bool forces(const double* displacements, double* forces) {
    for (std::size_t g = 0; g < place_.size(); ++g) displacement_[g] = displacements[place_[g]];
    const bool known = block_->forces(displacement_, force_);
    std::fill_n(forces, size(), 0.0);
    for (std::size_t g = 0; g < place_.size(); ++g) forces[place_[g]] += force_[g];
    return known;
  }

 private:
  std::shared_ptr<InstrumentForces> block_;
  std::size_t instruments_;
  std::vector<std::size_t> place_;  // of each gripped unknown: 3 * instrument + axis
  std::vector<double> displacement_, force_;
};

}  // namespace
}  // namespace sunder::c

extern "C" {

using namespace sunder::c;

sunder_status sunder_grips_create(sunder_simulation simulation, sunder_grips* grips) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(grips, "grips");
    if (object.problem().gripped_dofs().empty()) {
      throw Failure(SUNDER_ERROR_ORDER, "the scene has no instrument that holds nodes (a grip)");
    }
    auto block = object.simulation().backend().instrument_forces();
    if (!block) {
      const auto info = object.simulation().backend().info();
      throw Failure(SUNDER_ERROR_DEVICE,
                    "backend " + info.backend + ", route " + info.route + ", update " +
                        info.update + " gives no forces between frames; choose route inverse or " +
                        "condensed, update deferred");
    }
    if (!object.grips.expired()) {
      throw Failure(SUNDER_ERROR_ORDER, "the simulation's grips have a handle already");
    }
    auto made = std::make_shared<GripsObject>(object.problem(), std::move(block));
    object.grips = made;
    *grips = new_handle<sunder_grips>(std::move(made));
  });
}

sunder_status sunder_grips_destroy(sunder_grips grips) { return destroy<GripsObject>(grips); }

sunder_status sunder_grips_forces(sunder_grips grips, const double* displacements, double* forces,
                                  size_t size) {
  return call<GripsObject>(grips, [&](GripsObject& object) {
    require_size(size, object.size(), "forces");
    require(displacements, "displacements");
    require(forces, "forces");
    if (object.forces(displacements, forces)) return;
    if (!std::all_of(displacements, displacements + size,
                     [](double d) { return std::isfinite(d); })) {
      throw Failure(SUNDER_ERROR_VALUE, "a displacement is not finite");
    }
    throw Failure(SUNDER_ERROR_ORDER, "there are no forces before the first step");
  });
}

}  // extern "C"
