// SPDX-License-Identifier: Apache-2.0
// The ways of the CPU to apply the inverse of the damaged stiffness. Two are the plain yardstick: a
// dense inverse with eager updates, and conjugate gradients preconditioned by the intact factor.
// Where that factor is larger than the memory an incomplete one takes its place. The others take
// from the solver (core/solver): deferred updates over an inverse or over a factor; route condensed
// is the solver's own (solver/condensed_route.hpp).
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <memory>
#include <vector>

#include "body/damaged_body.hpp"
#include "cpu_reference/intact_body.hpp"
#include "solver/inverse_route.hpp"
#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

using fem::DamagedBody;
using solver::Applied;
using solver::InverseRoute;

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
