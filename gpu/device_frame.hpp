// SPDX-License-Identifier: Apache-2.0
// A frame on the device: its route's solution, residual and stress, as the solver of a frame asks
// for them (core/solver/frame_device.hpp).
#pragma once

#include "gpu/route.hpp"
#include "solver/frame_device.hpp"

namespace sunder::gpu {

class DeviceFrame final : public solver::FrameDevice {
 public:
  /// What it refers to must outlive it. `fp64`: storage precision of the inverse.
  DeviceFrame(const fem::DamagedBody& body, Fields& fields, DeviceRoute& route, bool fp64)
      : problem_(body.problem()), body_(body), fields_(fields), route_(route), fp64_(fp64) {}

  void set_load(const Load& load);

  [[nodiscard]] solver::Precision precision() const override;
  [[nodiscard]] bool residual_costs() const override { return true; }
  [[nodiscard]] bool iterates() const override { return route_.iterates(); }
  int solve(double energy_tolerance, solver::Residual residual) override;
  [[nodiscard]] solver::Balance balance() const override;
  [[nodiscard]] bool finite() const override { return fields_.finite(); }
  Correction correct(bool add) override;
  [[nodiscard]] bool adds_at_once() const override { return route_.corrects_on_host(); }
  void add_correction() override { route_.add_correction(); }
  bool sum_by_elements(bool on) override;
  bool rebase() override { return route_.rebase(); }
  [[nodiscard]] const solver::Deferred* deferred() const override;
  [[nodiscard]] int bases() const override;
  [[nodiscard]] const solver::BaseCheck& base_check() const override;

 private:
  void sum_residual();
  void read_along(bool by_elements);
  [[nodiscard]] int correct_by_elements(bool add);

  const Problem& problem_;
  const fem::DamagedBody& body_;
  Fields& fields_;
  DeviceRoute& route_;
  bool fp64_;
  Load load_;
  double force_squared_ = 0;
  bool by_elements_ = false;
  bool first_ = false,
       first_by_elements_ = false;      // correction of a solution; the last one of them
  std::vector<double> nodal_, padded_;  // of by_elements_: u, r
  Eigen::VectorXd u_, r_;
};

}  // namespace sunder::gpu
