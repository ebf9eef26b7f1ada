// SPDX-License-Identifier: Apache-2.0
// Forces of the grips between frames, for a thread of their own.
#include <algorithm>
#include <cmath>

#include "c/simulation.hpp"
#include "c/structs.hpp"
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
  void blend(double ms) { block_->blend(ms); }

  /// Forces of the scene's grips (both null: they hold still) and of hands on a host's. Throws,
  /// with forces of 0 and `felt` filled, when there are none.
  void feel(const double* displacements, double* forces, std::span<sunder_hand> hands,
            sunder_felt* felt) {
    const bool own = forces != nullptr;
    for (std::size_t g = 0; own && g < place_.size(); ++g) {
      displacement_[g] = displacements[place_[g]];
    }
    none(forces, hands);  // may be the array of the displacements
    if (gone_->load()) end(SUNDER_FELT_GONE, felt);
    for (std::size_t g = 0; own && g < place_.size(); ++g) {
      if (std::isfinite(displacement_[g])) continue;
      say({FeltState::overflow}, felt);
      not_finite(displacement_[g], static_cast<std::ptrdiff_t>(place_[g]), "displacements");
    }
    take(hands, felt);
    const Felt now =
        own ? block_->feel(displacement_, force_, hands_) : block_->feel({}, {}, hands_);
    if (now.state != FeltState::live) end(static_cast<std::int32_t>(now.state), felt);
    for (std::size_t g = 0; own && g < place_.size(); ++g) forces[place_[g]] += force_[g];
    bool finite =
        !own || std::all_of(forces, forces + size(), [](double f) { return std::isfinite(f); });
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const Hand& hand = hands_[i];
      finite = finite && hand.force.allFinite() && hand.torque.allFinite();
      hands[i].held = hand.held ? 1 : 0;
      std::copy_n(hand.force.data(), 3, hands[i].force);
      std::copy_n(hand.torque.data(), 3, hands[i].torque);
    }
    if (!finite) {  // each node's was, their sum is not
      none(forces, hands);
      end(SUNDER_FELT_OVERFLOW, felt);
    }
    say(now, felt);
  }

 private:
  void none(double* forces, std::span<sunder_hand> hands) const {
    if (forces) std::fill_n(forces, size(), 0.0);
    for (sunder_hand& hand : hands) {
      hand.held = 0;
      std::fill_n(hand.force, 3, 0.0);
      std::fill_n(hand.torque, 3, 0.0);
    }
  }

  /// The hands as the library has them. Room for as many as ever is kept.
  void take(std::span<const sunder_hand> hands, sunder_felt* felt) {
    hands_.resize(hands.size());
    for (std::size_t i = 0; i < hands.size(); ++i) {
      const sunder_hand& of = hands[i];
      try {
        require_finite(of.position, 3, "position");
        require_finite(of.quaternion, 4, "quaternion");
      } catch (const Failure&) {
        say({FeltState::overflow}, felt);
        throw;
      }
      if (std::all_of(of.quaternion, of.quaternion + 4, [](double q) { return q == 0; })) {
        say({FeltState::overflow}, felt);
        throw Failure(SUNDER_ERROR_VALUE,
                      "quaternion has length 0; of no turn it is 0, 0, 0, 1 (x, y, z, w)");
      }
      hands_[i].grip = of.grip;
      hands_[i].position = Vec3(of.position);
      std::copy_n(of.quaternion, 4, hands_[i].quaternion.begin());
    }
  }

  static void say(const Felt& of, sunder_felt* felt) {
    if (!felt) return;
    auto out = sized<sunder_felt>();
    out.state = static_cast<std::int32_t>(of.state);
    out.solution = of.solution;
    out.step = of.step;
    out.age_ms = of.age_ms;
    out.share = of.share;
    write_struct(felt, out, "felt");
  }

  [[noreturn]] static void end(std::int32_t state, sunder_felt* felt) {
    say({static_cast<FeltState>(state)}, felt);
    if (state == SUNDER_FELT_GONE) {
      throw Failure(SUNDER_ERROR_HANDLE, "the simulation of these grips was destroyed");
    }
    if (state == SUNDER_FELT_WAITING) {
      throw Failure(SUNDER_ERROR_ORDER, "there are no forces before the first step");
    }
    throw Failure(SUNDER_ERROR_VALUE, "the displacements are so large that their forces overflow");
  }

  std::shared_ptr<InstrumentForces> block_;
  std::shared_ptr<const std::atomic<bool>> gone_;
  std::size_t instruments_;
  std::vector<std::size_t> place_;  // of each gripped unknown: 3 * instrument + axis
  std::vector<double> displacement_, force_;
  std::vector<Hand> hands_;
};

}  // namespace
}  // namespace sunder::c

extern "C" {

using namespace sunder::c;

sunder_status sunder_grips_create(sunder_simulation simulation, sunder_grips* grips) {
  return call<SimulationObject>(simulation, [&](SimulationObject& object) {
    require(grips, "grips");
    if (!object.simulation().backend().has_grips()) {
      throw Failure(
          SUNDER_ERROR_ORDER,
          "the scene has no instrument that holds nodes (a grip), and none can be grasped");
    }
    auto block = object.simulation().grip_forces();
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
    object.feel(displacements, forces, {}, nullptr);
  });
}

sunder_status sunder_grips_feel(sunder_grips grips, const double* displacements, double* forces,
                                size_t size, sunder_hand* hands, size_t count, sunder_felt* felt) {
  return call<GripsObject>(grips, [&](GripsObject& object) {
    if (felt) static_cast<void>(stated_size(felt, "felt"));
    if (displacements || forces || size > 0) {
      require_size(size, object.size(), "forces");
      require(displacements, "displacements");
      require(forces, "forces");
    }
    if (count > 0) require(hands, "hands");
    require_rows(count, "hands");
    object.feel(displacements, forces, {hands, count}, felt);
  });
}

sunder_status sunder_grips_blend(sunder_grips grips, double ms) {
  return call<GripsObject>(grips, [&](GripsObject& object) {
    if (!(ms >= 0) || !std::isfinite(ms)) {
      throw Failure(SUNDER_ERROR_VALUE,
                    "ms = " + std::to_string(ms) + " is not a time in ms, nor 0 for none");
    }
    object.blend(ms);
  });
}

}  // extern "C"
