// SPDX-License-Identifier: Apache-2.0
// What the device has of a problem's body: all of it or, on route condensed, the region that can
// break, which numbers unknowns and elements anew; with its fields and the route that solves it.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/region.hpp"
#include "engine/substructure.hpp"
#include "gpu/inverse_route.hpp"
#include "gpu/plan.hpp"

namespace sunder::gpu {

using IntactInverse = std::shared_ptr<const HostInverse>;

/// What every body of a backend is made with; all of it outlives the body.
struct DeviceSetup {
  const KernelFactory& kernels;
  const Plan& plan;
  const InverseOptions& inverse;  ///< of routes inverse and condensed
  const Needs& needs;
};

class DeviceBody {
 public:
  /// `region`: what alone goes to the device, none: the whole. `started`: the whole body's inverse
  /// where it is being computed already, else not valid.
  DeviceBody(const DeviceSetup& setup, std::shared_ptr<const Problem> whole,
             std::optional<engine::Region> region, std::future<IntactInverse> started = {});

  /// Problem that the device solves: the whole body's, or the region's with its surroundings.
  [[nodiscard]] const Problem& part() const { return *part_; }
  /// Null: the whole is there.
  [[nodiscard]] const engine::Substructure* region() const { return region_.get(); }
  /// The same with its damage.
  [[nodiscard]] const engine::DamagedBody& damaged() const { return *damaged_; }
  /// Follows an event, elements as the device numbers them.
  void destroy(std::span<const Index> elements);
  [[nodiscard]] Fields& fields() const { return *fields_; }
  [[nodiscard]] DeviceRoute& route() const { return *route_; }
  [[nodiscard]] std::vector<BufferPlan> buffers() const;

  /// Elements as the device numbers them, without those that are not there; until the next call.
  [[nodiscard]] std::span<const Index> on_device(std::span<const Index> elements);
  [[nodiscard]] Index of_whole(std::uint32_t on_device) const;
  [[nodiscard]] bool holds(Index element) const {
    return !region_ || region_->element(element) != kNone;
  }
  /// A load of the whole as the device has it.
  [[nodiscard]] Load load(const Load& of_whole);

  /// The fields are now those of a solution under this load.
  void solved(const Load& of_whole);
  /// Publishes a displacement of all nodes of the whole, and the stress that goes with it.
  void show(std::span<const double> displacement);

  /// Displacement of the last solution at all nodes of the whole: outside a region it is solved
  /// for, once a solution. A region only.
  [[nodiscard]] std::span<const double> whole_displacement() const;
  void read_displacement(std::span<double> displacement) const;
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const;
  void read_stress(std::span<Voigt> stress) const;
  [[nodiscard]] Voigt read_stress(Index element) const;
  /// Largest norm of a field's stress outside the region: the rest may be stiffer and feel what
  /// the region does not. A region only.
  [[nodiscard]] double largest_outside(Field field, const Load& of_whole) const;

  /// Displacement of the intact body at all nodes of the whole; needs().pristine only.
  void solve_pristine(const Load& of_whole, std::span<double> displacement) const;

 private:
  void prepare_intact(const DeviceSetup& setup, std::future<IntactInverse> started);
  void make_route(const DeviceSetup& setup);
  void read_nodes(std::span<const Index> nodes, std::span<Vec3> displacement) const;

  const KernelFactory& kernels_;
  const Problem& whole_;
  std::unique_ptr<engine::Substructure> region_;
  std::shared_ptr<const Problem> part_;  // the region's or the whole
  std::unique_ptr<engine::DamagedBody> damaged_;
  std::unique_ptr<Fields> fields_;
  IntactInverse intact_;
  mutable std::unique_ptr<engine::Deferred> pristine_;  // of the intact body: its grips
  std::unique_ptr<DeviceRoute> route_;
  std::vector<Index> in_part_;
  // Of a region: the load of the last solution, and its displacement once read.
  Load solved_load_;
  mutable std::vector<double> whole_u_;
  mutable bool whole_u_known_ = false;
};

}  // namespace sunder::gpu
