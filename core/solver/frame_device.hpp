// SPDX-License-Identifier: Apache-2.0
// What the solver of a frame (frame_solver.hpp) asks of a device: the damaged body under the load
// that it was given last, a solution in work, its residual and its stress, and a correction.
#pragma once

#include <optional>

#include "solver/base_check.hpp"
#include "solver/deferred.hpp"

namespace sunder::solver {

/// The errors of stress that a device's arithmetic stands for.
struct Precision {
  double refined = 0;   ///< a full check refines silently down to this
  double kept = 0;      ///< up to this a base is kept
  double promised = 0;  ///< the estimate from the residual vouches for no more than this
};

/// A solution in work, as its checks see it.
struct Balance {
  double residual = 0;        ///< |f - K u| over the unknowns that no grip holds [N]
  double load_squared = 0;    ///< |f|^2 and the reactions' [N^2]
  double largest_u = 0;       ///< [mm]
  double largest_stress = 0;  ///< over the live elements that a frame computes [MPa]
};

/// What is wanted of f - K u of a solution.
enum class Residual {
  none,
  size,   ///< Balance::residual
  whole,  ///< and all of it for FrameDevice::correct(), which is going to be called
};

class FrameDevice {
 public:
  FrameDevice() = default;
  FrameDevice(const FrameDevice&) = delete;
  FrameDevice& operator=(const FrameDevice&) = delete;
  virtual ~FrameDevice() = default;

  [[nodiscard]] virtual Precision precision() const = 0;
  /// A plain route that others are measured by: it refines once in any case.
  [[nodiscard]] virtual bool yardstick() const { return false; }
  /// Solves by iterations to a residual of the same kind every time, by no base that wears out.
  [[nodiscard]] virtual bool iterates() const { return false; }
  /// Whether the residual costs a pass of its own, to be left out where nothing depends on it.
  [[nodiscard]] virtual bool residual_costs() const { return false; }

  /// Puts a solution in work, with its residual if wanted, and its stress. The deferred update may
  /// stop refining at `energy_tolerance` [N mm] (Deferred::solve). Returns iterations of conjugate
  /// gradients.
  virtual int solve(double energy_tolerance, Residual residual) = 0;
  /// Of the solution in work.
  [[nodiscard]] virtual Balance balance() const = 0;
  /// Whether the solution in work is made of numbers, where its residual was left out.
  [[nodiscard]] virtual bool finite() const { return true; }

  struct Correction {
    double stress = 0;  ///< largest over live elements [MPa]; infinite: there is none
    int iterations = 0;
  };
  /// du = A^-1 r of the solution in work, grips at 0; `add`: and as add_correction().
  virtual Correction correct(bool add) = 0;
  /// Whether both at once cost less than one after the other.
  [[nodiscard]] virtual bool adds_at_once() const { return false; }
  /// u += du, with residual and stress.
  virtual void add_correction() = 0;

  /// Turns to a residual that is summed element by element, where the usual one rounds more (a
  /// part that hangs on one element turns far for its strain), and back; false: it always is.
  virtual bool sum_by_elements(bool /*on*/) { return false; }
  /// Computes anew what updates have worn out; false: there is nothing of the kind.
  virtual bool rebase() { return false; }
  /// Turns to conjugate gradients on the intact body and back again; false: there are none.
  virtual bool fall_back(bool /*on*/) { return false; }

  /// The deferred update, where there is one: it makes a frame's check cheap.
  [[nodiscard]] virtual const Deferred* deferred() const { return nullptr; }
  /// Bases there have been so far: another one needs a full check.
  [[nodiscard]] virtual int bases() const { return 1; }
  /// Of the newest base, if whoever made it has checked it.
  [[nodiscard]] virtual const BaseCheck& base_check() const {
    static const BaseCheck none;
    return none;
  }

  /// Whether solve_region() solves for a region alone: such a frame has no residual.
  [[nodiscard]] virtual bool condensed() const { return false; }
  struct OnRegion {
    double largest_u = 0, largest_stress = 0;  ///< [mm], [MPa]
  };
  /// Puts the solution on the region in work.
  virtual OnRegion solve_region(double /*energy_tolerance*/) { return {}; }
  /// As InverseRoute's.
  [[nodiscard]] virtual int factor() const { return 1; }
  [[nodiscard]] virtual bool drifts() const { return false; }
  /// By how much of its largest stress solve() has refined the solution on the region before
  /// anything else, where the base drifts.
  [[nodiscard]] virtual double mended() const { return 0; }
  struct RefinedOnRegion {
    double stress = 0;  ///< largest of what was added [MPa]
    OnRegion solution;
  };
  /// As InverseRoute's refines().
  [[nodiscard]] virtual bool refines_region() const { return false; }
  /// Refines the solution of solve_region() once; nothing: it cannot be had on the region alone.
  virtual std::optional<RefinedOnRegion> refine_region() { return std::nullopt; }
  /// Of a solution that solve() has put in work.
  virtual OnRegion on_region() { return {}; }
};

}  // namespace sunder::solver
