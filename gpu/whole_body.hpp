// SPDX-License-Identifier: Apache-2.0
// The whole body on the device, with the route that solves it there.
#pragma once

#include <future>

#include "gpu/device_body.hpp"
#include "gpu/device_frame.hpp"

namespace sunder::gpu {

class WholeBody final : public DeviceBody {
 public:
  /// `started`: the body's inverse where it is being computed already, else not valid.
  WholeBody(const DeviceSetup& setup, std::future<IntactInverse> started);

  const Problem& part() const override { return problem_; }
  Fields& fields() override { return fields_; }
  const Fields& fields() const override { return fields_; }
  std::span<const Index> on_device(std::span<const Index> elements) override { return elements; }
  Index of_whole(std::uint32_t on_device) const override { return static_cast<Index>(on_device); }

  solver::FrameDevice& frame() override { return *frame_; }
  void set_load(const Load& load) override;
  void keep() override { fields_.keep_next(); }
  void restore() override { fields_.restore(); }
  void publish(bool) override {}
  void destroy(std::span<const Index> elements) override;
  void grip(const fem::Event& event, std::span<const Index> before) override;

  void read_displacement(std::span<double> displacement) const override {
    fields_.read_displacement(displacement);
  }
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const override;
  void read_stress(std::span<Voigt> stress) const override { fields_.read_stress(stress); }
  Voigt read_stress(Index element) const override { return fields_.read_stress(element); }
  void read_reactions(std::span<double> reactions) const override {
    fields_.read_reactions(damaged_.forms().gripped(), reactions);
  }
  const Eigen::MatrixXd* grip_factor() const override { return route_->grip_factor(); }
  void solve_pristine(const Load& load, std::span<double> displacement) override;

  std::vector<BufferPlan> buffers() const override;
  std::size_t host_solves() const override { return route_->host_solves(); }
  void add_to(solver::FrameShape& shape) const override { route_->add_to(shape); }
  const solver::RenewedUpdate* update() const override { return route_->update(); }
  NewBases new_bases() const override { return update() ? update()->new_bases() : NewBases{}; }

 private:
  void make_route(const DeviceSetup& setup, IntactInverse intact);

  const Problem& problem_;
  const fem::DamagedBody& damaged_;
  Fields fields_;
  std::shared_ptr<solver::Deferred> pristine_;  // of the intact body: its grips
  std::unique_ptr<DeviceRoute> route_;
  std::optional<DeviceFrame> frame_;
  std::vector<Index> loaded_;  // unknowns of the last load
  std::vector<double> force_;  // over the padded unknowns
  bool mapped_;                // the host reads the device's memory itself
};

}  // namespace sunder::gpu
