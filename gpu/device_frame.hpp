// SPDX-License-Identifier: Apache-2.0
// A frame on the device: its route's solution, residual and stress, as the solver of a frame asks
// for them (core/engine/frame_device.hpp).
#pragma once

#include "engine/frame_device.hpp"
#include "gpu/route.hpp"

namespace sunder::gpu {

class DeviceFrame final : public engine::FrameDevice {
 public:
  /// What it refers to must outlive it. `fp64`: storage precision of the inverse.
  DeviceFrame(const engine::DamagedBody& body, Fields& fields, DeviceRoute& route, bool fp64)
      : problem_(body.problem()), body_(body), fields_(fields), route_(route), fp64_(fp64) {}

  void set_load(const Load& load);

  [[nodiscard]] engine::Precision precision() const override;
  [[nodiscard]] bool residual_costs() const override { return true; }
  int solve(double enough, bool residual) override;
  [[nodiscard]] engine::Balance balance() const override;
  [[nodiscard]] bool finite() const override { return fields_.finite(); }
  Correction correct() override;
  void add_correction() override { route_.add_correction(); }
  bool sum_by_elements(bool on) override;
  bool rebase() override { return route_.rebase(); }
  [[nodiscard]] const engine::Deferred* deferred() const override;
  [[nodiscard]] int bases() const override;
  [[nodiscard]] const engine::BaseCheck& base_check() const override;

 private:
  void sum_residual();

  const Problem& problem_;
  const engine::DamagedBody& body_;
  Fields& fields_;
  DeviceRoute& route_;
  bool fp64_;
  Load load_;
  double force_squared_ = 0;
  bool by_elements_ = false;
  std::vector<double> nodal_, padded_;  // of by_elements_: u, r
  Eigen::VectorXd u_, r_;
};

}  // namespace sunder::gpu
