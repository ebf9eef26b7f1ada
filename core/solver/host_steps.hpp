// SPDX-License-Identifier: Apache-2.0
// The steps of an iteration at finite deformation by the host.
#pragma once

#include "solver/finite_potential.hpp"
#include "solver/finite_steps.hpp"
#include "solver/lbfgs.hpp"

namespace sunder::solver {

class HostSteps final : public FiniteSteps {
 public:
  /// The potential must outlive it. `pairs`: of L-BFGS.
  HostSteps(const FinitePotential& potential, int pairs) : potential_(potential), hessian_(pairs) {}

  FinitePoint begin(const FiniteTarget& target, FiniteBase* base, FiniteState& state) override;
  FiniteTrial whole(bool with_stress) override;
  FiniteTrial part(double of, bool with_stress) override;
  void take() override;
  void end() override {}

 private:
  [[nodiscard]] FiniteTrial trial(double part, bool with_stress);

  const FinitePotential& potential_;
  Lbfgs hessian_;
  const FiniteTarget* target_ = nullptr;
  FiniteBase* base_ = nullptr;
  FiniteState* state_ = nullptr;
  FiniteState next_;
  Eigen::VectorXd du_, s_, y_;
};

}  // namespace sunder::solver
