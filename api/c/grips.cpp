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

  GripsObject(const Problem& problem, std::shared_ptr<InstrumentForces> block,
              std::shared_ptr<const std::atomic<bool>> gone)
      : block_(std::move(block)),
        gone_(std::move(gone)),
        instruments_(problem.scene().instruments.size()) {
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

  /// Throws, with forces of 0, when there are none.
  void forces(const double* displacements, double* forces) {
    for (std::size_t g = 0; g < place_.size(); ++g) displacement_[g] = displacements[place_[g]];
    std::fill_n(forces, size(), 0.0);  // may be the array of the displacements
    if (gone_->load()) {
      throw Failure(SUNDER_ERROR_HANDLE, "the simulation of these grips was destroyed");
    }
    for (std::size_t g = 0; g < place_.size(); ++g) {
      if (std::isfinite(displacement_[g])) continue;
      not_finite(displacement_[g], static_cast<std::ptrdiff_t>(place_[g]), "displacements");
    }
    if (!block_->forces(displacement_, force_)) explain();
    for (std::size_t g = 0; g < place_.size(); ++g) forces[place_[g]] += force_[g];
    const bool finite =
        std::all_of(forces, forces + size(), [](double f) { return std::isfinite(f); });
    if (finite) return;
    std::fill_n(forces, size(), 0.0);  // each node's was finite, their sum is not
    overflow();
  }

 private:
  [[noreturn]] static void overflow() {
    throw Failure(SUNDER_ERROR_VALUE, "the displacements are so large that their forces overflow");
  }

  /// Returns when the first frame came in between, with the forces that it gives.
  void explain() {
    if (!block_->forces(std::vector<double>(place_.size()), force_)) {
      throw Failure(SUNDER_ERROR_ORDER, "there are no forces before the first step");
    }
    if (!block_->forces(displacement_, force_)) overflow();
  }

  std::shared_ptr<InstrumentForces> block_;
  std::shared_ptr<const std::atomic<bool>> gone_;
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
    auto made = std::make_shared<GripsObject>(object.problem(), std::move(block), object.gone);
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
    object.forces(displacements, forces);
  });
}

}  // extern "C"
