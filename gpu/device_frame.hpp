// SPDX-License-Identifier: Apache-2.0
// A frame on the device: its route's solution, residual and stress, as the solver of a frame asks
// for them (core/engine/frame_device.hpp).
#pragma once

#include "engine/frame_device.hpp"
#include "gpu/device_body.hpp"

namespace sunder::gpu {

class DeviceFrame final : public engine::FrameDevice {
 public:
  /// The body must outlive it. `fp64`: storage precision of the inverse.
  DeviceFrame(DeviceBody& body, bool fp64) : body_(body), fp64_(fp64) {}

  /// A load as the device numbers its unknowns; `whole`: of a region's problem.
  void set_load(const Load& load, const Load& whole);

  [[nodiscard]] engine::Precision precision() const override;
  [[nodiscard]] bool residual_costs() const override { return true; }
  int solve(double enough, bool residual) override;
  [[nodiscard]] engine::Balance balance() const override;
  [[nodiscard]] double largest_everywhere() const override;
  [[nodiscard]] bool finite() const override { return body_.fields().finite(); }
  Correction correct() override;
  void add_correction() override { body_.route().add_correction(); }
  bool rebase() override { return body_.route().rebase(); }
  [[nodiscard]] const engine::Deferred* deferred() const override;
  [[nodiscard]] int bases() const override;
  [[nodiscard]] const engine::BaseCheck& base_check() const override;

 private:
  DeviceBody& body_;
  bool fp64_;
  Load load_, whole_;
  double force_squared_ = 0;
};

}  // namespace sunder::gpu
