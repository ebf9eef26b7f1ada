// SPDX-License-Identifier: Apache-2.0
// One way to apply the inverse of the damaged stiffness on the device.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "gpu/passes/fields.hpp"
#include "gpu/vulkan/commands.hpp"
#include "solver/frame_cost.hpp"
#include "solver/renewed_update.hpp"
#include "sunder/backend.hpp"
#include "sunder/error.hpp"

namespace sunder::gpu {

class DeviceRoute {
 public:
  virtual ~DeviceRoute() = default;
  DeviceRoute() = default;
  DeviceRoute(const DeviceRoute&) = delete;
  DeviceRoute& operator=(const DeviceRoute&) = delete;

  /// Displacement under a load, and Fields' state of it, with f - K u if `balance`. The deferred
  /// update may stop refining at `energy_tolerance` [N mm]. Returns iterations.
  virtual int solve(const Load& load, double energy_tolerance, bool balance) = 0;
  /// Correction = A^-1 r with grips at 0, and Fields' summary of it; `add`: and as
  /// add_correction(). Returns iterations.
  virtual int correct(bool add) = 0;
  /// The same of a residual r that the host has. False, and nothing is done: it reads the fields'.
  virtual bool correct_by_host(const Eigen::VectorXd& /*r*/, bool /*add*/) { return false; }
  /// Whether correct() takes the residual to the host, and adds in the submit of its estimate.
  [[nodiscard]] virtual bool corrects_on_host() const { return false; }
  /// Displacement += correction, and Fields' state anew.
  virtual void add_correction() = 0;
  /// Follows an event; the body has destroyed the elements already.
  virtual void destroy(std::span<const Index> elements) = 0;
  /// Follows an event of grips; the fields know those that are there now.
  virtual void grip(const fem::Event&) { throw UsageError("this route takes no other grips"); }
  /// Computes anew what updates have worn out; false: this route has nothing of the kind.
  virtual bool rebase() { return false; }

  /// The deferred update over the present base; null: this route has none.
  [[nodiscard]] virtual const solver::RenewedUpdate* update() const { return nullptr; }
  /// L with L L^T = (A^-1)_GG of the gripped unknowns, a lower triangle; null: the route has none.
  [[nodiscard]] virtual const Eigen::MatrixXd* grip_factor() const {
    return update() ? &update()->deferred().grip_factor() : nullptr;
  }

  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
  /// Right sides that the host's factors have solved for so far.
  [[nodiscard]] virtual std::size_t host_solves() const { return 0; }
  /// solver::FrameDevice::iterates().
  [[nodiscard]] virtual bool iterates() const { return false; }
  /// What a prediction of its frames has to know of it.
  virtual void add_to(solver::FrameShape&) const {}
};

}  // namespace sunder::gpu
