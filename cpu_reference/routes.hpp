// SPDX-License-Identifier: Apache-2.0
// The ways of the CPU to apply the inverse of the damaged stiffness. Two are the plain yardstick: a
// dense inverse with eager updates, and conjugate gradients preconditioned by the intact factor.
// Where that factor is larger than the memory an incomplete one takes its place. The others take
// from the engine (core/engine): deferred updates over an inverse, over a factor, or over the
// inverse of a region's unknowns alone.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <memory>
#include <vector>

#include "cpu_reference/intact_body.hpp"
#include "engine/base_check.hpp"
#include "engine/condensed_base.hpp"
#include "engine/damaged_body.hpp"
#include "engine/deferred.hpp"
#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

using engine::DamagedBody;

struct Applied {
  int iterations = 0;
  bool converged = true;
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
  /// What complete() would need later on, for the last solve(); false: it left nothing out.
  virtual bool equilibrium(engine::Equilibrium&) const { return false; }
  /// Follows an event; the body has destroyed the elements already.
  virtual void destroy(std::span<const Index> elements) = 0;
  /// Whether prepare() is worth calling.
  [[nodiscard]] virtual bool prepares() const { return false; }
  virtual void prepare(std::span<const Index>) {}
  /// Milliseconds that events have been spared so far.
  [[nodiscard]] virtual double saved_ms() const { return 0; }
  /// Computes anew what updates have worn out; false: this route has nothing of the kind.
  virtual bool rebase() { return false; }
  /// The deferred update, where there is one: it makes a frame's check cheap.
  [[nodiscard]] virtual const engine::Deferred* deferred() const { return nullptr; }
  /// A deferred update may stop refining at this energy of the defect [N mm].
  virtual void set_enough(double) {}
  /// Bases there have been so far: another one needs a full check.
  [[nodiscard]] virtual int bases() const { return 1; }
  /// Of the newest base, if whoever made it has checked it.
  [[nodiscard]] virtual const engine::BaseCheck& base_check() const {
    static const engine::BaseCheck none;
    return none;
  }
  /// Milliseconds that frames have waited for a rebase so far.
  [[nodiscard]] virtual double waited_ms() const { return 0; }
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
};

/// An incomplete factor of the intact stiffness, with as many entries as the stiffness has.
class IncompleteFactor;

[[nodiscard]] std::unique_ptr<InverseRoute> dense_inverse_route(const DamagedBody& body,
                                                                const IntactBody& intact);
/// Deferred update over a dense inverse (`dense`) or over the factor itself. Takes the intact
/// body's stiffness; without one nothing will be destroyed. `rest`: of the thread that makes new
/// bases (background_rebase.hpp).
[[nodiscard]] std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body,
                                                           IntactBody& intact, bool dense,
                                                           std::chrono::milliseconds rest);
/// Deferred update over the inverse restricted to some unknowns (ascending).
[[nodiscard]] std::unique_ptr<InverseRoute> condensed_route(const DamagedBody& body,
                                                            const IntactBody& intact,
                                                            std::span<const Index> dofs,
                                                            bool damage,
                                                            std::chrono::milliseconds rest);
[[nodiscard]] std::unique_ptr<InverseRoute> conjugate_gradient_route(const DamagedBody& body,
                                                                     const IntactBody& intact);
/// Conjugate gradients without any factor, for bodies whose factor is larger than the memory;
/// `preconditioner` may serve several bodies of one problem.
[[nodiscard]] std::unique_ptr<InverseRoute> incomplete_route(
    const DamagedBody& body, std::shared_ptr<const IncompleteFactor> preconditioner);
[[nodiscard]] std::shared_ptr<const IncompleteFactor> incomplete_factor(const Problem& problem);

/// The intact body where there is no factor of it.
class NeverDamaged {
 public:
  NeverDamaged(std::shared_ptr<const Problem> problem,
               std::shared_ptr<const IncompleteFactor> preconditioner)
      : body_(std::move(problem)), route_(incomplete_route(body_, std::move(preconditioner))) {}
  /// Throws NumericalError when conjugate gradients do not converge.
  void solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& x) const;

 private:
  DamagedBody body_;
  std::unique_ptr<InverseRoute> route_;
};

}  // namespace sunder::cpu_reference
