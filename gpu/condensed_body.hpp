// SPDX-License-Identifier: Apache-2.0
// Route condensed: the host solves for the region by the engine's own route (condensed_route.hpp),
// in fp64 and at the price of what the region is large; the device has the region's displacement,
// stress, summary and list of elements over yield, and on a GPU the product with many columns. What
// lies outside is solved for when somebody reads it.
#pragma once

#include "gpu/device_body.hpp"
#include "gpu/passes/damage_solution.hpp"
#include "gpu/passes/region_inverse.hpp"
#include "solver/condensed_fields.hpp"
#include "solver/condensed_route.hpp"
#include "solver/host_frame.hpp"
#include "solver/region_part.hpp"

namespace sunder::gpu {

class CondensedBody final : public DeviceBody, private solver::HostFields {
 public:
  CondensedBody(const DeviceSetup& setup, const solver::Region& region);

  const Problem& part() const override { return *part_.problem(); }
  Fields& fields() override { return fields_; }
  const Fields& fields() const override { return fields_; }
  const solver::Region* region() const override { return &outside_.region(); }
  std::span<const Index> on_device(std::span<const Index> elements) override;
  Index of_whole(std::uint32_t on_device) const override { return part_.elements()[on_device]; }

  solver::FrameDevice& frame() override { return frame_; }
  void set_load(const Load& load) override { frame_.set_load(load); }
  void keep() override {}
  void restore() override;
  void publish(bool everywhere) override;
  void publish_stress() override { outside_.publish_stress(); }
  void destroy(std::span<const Index> elements) override;
  void grip(const fem::Event& event, std::span<const Index> before) override;
  void prepare(std::span<const Index> elements) override { route_->prepare(elements); }

  void read_displacement(std::span<double> displacement) const override;
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const override;
  void read_stress(std::span<Voigt> stress) const override;
  Voigt read_stress(Index element) const override;
  void read_reactions(std::span<double> reactions) const override;
  const Eigen::MatrixXd* grip_factor() const override { return &route_->deferred()->grip_factor(); }
  void solve_pristine(const Load& load, std::span<double> displacement) override;

  std::vector<BufferPlan> buffers() const override;
  std::size_t host_solves() const override { return intact_->solved(); }
  NewBases new_bases() const override { return route_->new_bases(); }
  void add_to(solver::FrameShape& shape) const override {
    const solver::Deferred& deferred = *route_->deferred();
    shape.columns = static_cast<std::size_t>(deferred.rank() - deferred.grips());
    const Index touched = static_cast<const solver::CondensedBase&>(deferred.base()).touched();
    shape.region_there = inverse_ && inverse_->takes(touched);
    shape.touched = static_cast<std::size_t>(touched);
    shape.damage_there =
        damage_ && deferred.events() > 0 && damage_->takes(deferred.rank(), deferred.grips());
  }

 private:
  std::optional<double> take(const Eigen::VectorXd& u) override;
  void show();

  const Problem& problem_;
  const fem::DamagedBody& damaged_;
  solver::RegionPart part_;
  Fields fields_;
  vulkan::Commands commands_;
  IntactInverse intact_;                        // its factor
  std::shared_ptr<solver::Deferred> pristine_;  // of the intact body: its grips
  std::unique_ptr<RegionInverse> inverse_;      // null: the host multiplies
  std::unique_ptr<DamageSolution> damage_;      // likewise
  std::unique_ptr<solver::InverseRoute> route_;
  solver::HostFrame frame_;
  mutable solver::CondensedFields outside_;  // computes what is read
  // At the part's nodes: as published, in work; at the whole's, filled where it is read.
  std::vector<double> nodal_, next_nodal_;
  mutable std::vector<double> whole_nodal_;
  mutable bool whole_known_ = false;
  std::vector<Index> in_part_;
};

}  // namespace sunder::gpu
