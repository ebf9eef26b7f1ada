// SPDX-License-Identifier: Apache-2.0
// What the device has of a problem's body, with what solves it: all of it (whole_body.hpp) or, on
// route condensed, the fields of the region that can break (condensed_body.hpp).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gpu/inverse_route.hpp"
#include "solver/frame_device.hpp"
#include "solver/plan.hpp"

namespace sunder::gpu {

using IntactInverse = std::shared_ptr<const HostInverse>;

/// What every body of a backend is made with; all of it outlives the body.
struct DeviceSetup {
  const fem::DamagedBody& body;
  const KernelFactory& kernels;
  const solver::Plan& plan;
  const InverseOptions& inverse;
  const Needs& needs;
};

/// Elements, nodes and unknowns are the problem's.
class DeviceBody {
 public:
  DeviceBody() = default;
  DeviceBody(const DeviceBody&) = delete;
  DeviceBody& operator=(const DeviceBody&) = delete;
  virtual ~DeviceBody() = default;

  /// What the device computes the fields of, with numbers of its own.
  [[nodiscard]] virtual const Problem& part() const = 0;
  [[nodiscard]] virtual Fields& fields() = 0;
  [[nodiscard]] virtual const Fields& fields() const = 0;
  /// Elements as the device numbers them, without those that are not there; until the next call.
  [[nodiscard]] virtual std::span<const Index> on_device(std::span<const Index> elements) = 0;
  [[nodiscard]] virtual Index of_whole(std::uint32_t on_device) const = 0;

  /// For the solver of a frame: the load it was given, a solution in work.
  [[nodiscard]] virtual solver::FrameDevice& frame() = 0;
  virtual void set_load(const Load& load) = 0;
  /// The next solution is a new one: what is shown now comes back with restore().
  virtual void keep() = 0;
  virtual void restore() = 0;
  /// The solution in work holds; `everywhere`: not on a region alone.
  virtual void publish(bool everywhere) = 0;
  /// The stress of the published solution is what read_stress() says.
  virtual void publish_stress() {}
  /// Follows an event that the body has recorded already.
  virtual void destroy(std::span<const Index> elements) = 0;
  /// The same of grips; `before`: what was gripped.
  virtual void grip(const fem::Event& event, std::span<const Index> before) = 0;
  /// The host may destroy these next.
  virtual void prepare(std::span<const Index>) {}
  virtual void cut_off(std::span<const Index> elements) { fields().cut_off(on_device(elements)); }
  /// Outside a region nothing is a candidate.
  virtual void exclude(std::span<const Index> elements) { fields().exclude(on_device(elements)); }

  virtual void read_displacement(std::span<double> displacement) const = 0;
  virtual void read_displacement(std::span<const Index> nodes,
                                 std::span<Vec3> displacement) const = 0;
  virtual void read_stress(std::span<Voigt> stress) const = 0;
  [[nodiscard]] virtual Voigt read_stress(Index element) const = 0;
  virtual void read_reactions(std::span<double> reactions) const = 0;
  /// L with L L^T = (A^-1)_GG of the gripped unknowns, a lower triangle; null: there is none.
  [[nodiscard]] virtual const Eigen::MatrixXd* grip_factor() const = 0;
  /// Displacement of the intact body at all nodes; needs().pristine only.
  virtual void solve_pristine(const Load& load, std::span<double> displacement) = 0;

  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
  /// Right sides that the host's factors have solved for so far.
  [[nodiscard]] virtual std::size_t host_solves() const = 0;
  /// What a prediction of its frames has to know of it.
  virtual void add_to(solver::FrameShape&) const {}
  /// The deferred update of the whole body; null: it has another or none.
  [[nodiscard]] virtual const solver::RenewedUpdate* update() const { return nullptr; }
  /// Bases after the first one so far.
  [[nodiscard]] virtual NewBases new_bases() const = 0;
};

}  // namespace sunder::gpu
