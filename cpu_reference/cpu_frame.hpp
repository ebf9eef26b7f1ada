// SPDX-License-Identifier: Apache-2.0
// A frame on the CPU: the route's solution, its residual and its fields, as the solver of a frame
// asks for them (core/engine/frame_device.hpp).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cpu_reference/choose_route.hpp"
#include "cpu_reference/frame_fields.hpp"
#include "cpu_reference/routes.hpp"
#include "engine/frame_device.hpp"

namespace sunder::cpu_reference {

class CpuFrame final : public engine::FrameDevice {
 public:
  /// What it refers to must outlive it. `intact` is null where its factor does not fit the memory.
  CpuFrame(const ChosenRoute& chosen, const DamagedBody& body, const IntactBody* intact,
           InverseRoute& route, FrameFields& fields);

  void set_load(const Load& load);
  [[nodiscard]] const Load& load() const { return load_; }
  /// The solution in work holds. `everywhere`: not on a region alone.
  void publish(bool everywhere);
  /// Force that the grips exert on the body, one per gripped unknown.
  [[nodiscard]] std::span<const double> reactions() const { return reactions_; }

  [[nodiscard]] engine::Precision precision() const override;
  [[nodiscard]] bool yardstick() const override;
  int solve(double enough, bool residual) override;
  [[nodiscard]] engine::Balance balance() const override;
  Correction correct() override;
  void add_correction() override;
  bool rebase() override { return route_.rebase(); }
  bool fall_back(bool on) override;
  [[nodiscard]] const engine::Deferred* deferred() const override { return route_.deferred(); }
  [[nodiscard]] int bases() const override { return route_.bases(); }
  [[nodiscard]] const engine::BaseCheck& base_check() const override { return route_.base_check(); }
  [[nodiscard]] bool condensed() const override { return fields_.region() != nullptr; }
  OnRegion solve_region(double enough) override;
  OnRegion on_region() override;

 private:
  void look_at();
  void hand_out();
  [[nodiscard]] const Problem& problem() const { return body_.problem(); }
  [[nodiscard]] InverseRoute& route() { return cg_ ? *cg_ : route_; }
  /// Residual and stress come from the fields; the yardstick has loops of its own.
  [[nodiscard]] bool by_fields() const { return !condensed() && route_.deferred() != nullptr; }
  [[nodiscard]] double grip_force(std::size_t g) const;

  const ChosenRoute& chosen_;
  const DamagedBody& body_;
  const IntactBody* intact_;
  InverseRoute& route_;
  std::unique_ptr<InverseRoute> cg_;  // while a frame falls back
  FrameFields& fields_;
  std::vector<double> anchors_;  // stiffness of each gripped unknown's anchor

  Load load_;
  Eigen::VectorXd force_, u_, du_, product_, r_;
  std::vector<double> reactions_;
  double load_squared_ = 0, largest_ = 0;  // of the solution in work: its load, its stress
};

}  // namespace sunder::cpu_reference
