// SPDX-License-Identifier: Apache-2.0
// One way of the host to apply the inverse of the damaged stiffness.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "solver/base_check.hpp"
#include "solver/condensed_base.hpp"
#include "solver/deferred.hpp"

namespace sunder::solver {

struct Applied {
  int iterations = 0;
  bool converged = true;
};

/// What a route keeps of a state, to go back to it.
class RouteState {
 public:
  virtual ~RouteState() = default;
};

/// One way to apply the inverse of the damaged stiffness, grips held at zero.
class InverseRoute {
 public:
  virtual ~InverseRoute() = default;
  /// Displacement under a load with its grips. `f` is the force over the unknowns.
  virtual Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& x) = 0;
  /// x = A^-1 r with x_G = 0, to at least two digits.
  virtual Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& x) = 0;
  /// Fills what solve() left out of x: a condensed route solves for its own unknowns only.
  virtual void complete(Eigen::VectorXd&) {}
  /// The factor behind the base: the how manieth it is, from 1.
  [[nodiscard]] virtual int factor() const { return 1; }
  /// Whether the inverse that it works with is more than a factor's own, with an error beside that.
  [[nodiscard]] virtual bool drifts() const { return false; }
  /// Of a route that leaves some out: whether refine() can be had of the body as it is.
  [[nodiscard]] virtual bool refines() const { return false; }
  /// Refines the last solve() once on the route's own unknowns by the factor's own inverse and the
  /// damage, and gives what that has added to x there. False, and nothing changes: it cannot.
  virtual bool refine(const Load&, Eigen::VectorXd& /*x*/, Eigen::VectorXd& /*added*/) {
    return false;
  }
  /// The unknowns that solve() finds on a route that leaves some out.
  [[nodiscard]] virtual std::span<const Index> known() const { return {}; }
  /// What complete() would need later on, for the last solve(); false: it left nothing out.
  virtual bool equilibrium(Equilibrium&) const { return false; }
  /// Follows an event that the body has recorded already.
  virtual void follow(const fem::Event& event) = 0;
  /// The state of now; null: this route keeps none to go back to.
  [[nodiscard]] virtual std::unique_ptr<RouteState> state() const { return nullptr; }
  /// Goes back to one that it gave, after the first `events` events of the body, which still
  /// records those since. False, and nothing changes: it cannot.
  virtual bool go_back(const RouteState&, std::size_t /*events*/) { return false; }
  /// Whether prepare() is worth calling for what breaks by itself.
  [[nodiscard]] virtual bool prepares() const { return false; }
  /// The host may destroy these next.
  virtual void prepare(std::span<const Index>) {}
  /// Milliseconds that events have been spared so far.
  [[nodiscard]] virtual double saved_ms() const { return 0; }
  /// Computes anew what updates have worn out; false: this route has nothing of the kind.
  virtual bool rebase() { return false; }
  /// The deferred update, where there is one: it makes a frame's check cheap.
  [[nodiscard]] virtual const Deferred* deferred() const { return nullptr; }
  /// A deferred update may stop refining at this energy of the defect [N mm].
  virtual void set_energy_tolerance(double) {}
  /// Bases there have been so far: another one needs a full check.
  [[nodiscard]] virtual int bases() const { return 1; }
  /// Of the newest base, if whoever made it has checked it.
  [[nodiscard]] virtual const BaseCheck& base_check() const {
    static const BaseCheck none;
    return none;
  }
  /// Bases after the first one so far; going back takes none of these away.
  [[nodiscard]] virtual NewBases new_bases() const { return {}; }
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
};

}  // namespace sunder::solver
