// SPDX-License-Identifier: Apache-2.0
// One way to apply the inverse of the damaged stiffness on the device.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gpu/passes/fields.hpp"
#include "gpu/vulkan/commands.hpp"
#include "sunder/backend.hpp"

namespace sunder::gpu {

/// Energy norms sqrt(r^T A^-1 r) of a solution's residual r, from above.
struct EnergyBound {
  double whole = 0;
  double base = 0;     ///< the share that the base's inverse has in it
  double touched = 0;  ///< the share of the exact columns' unknowns and of the damage
};

class DeviceRoute {
 public:
  virtual ~DeviceRoute() = default;
  DeviceRoute() = default;
  DeviceRoute(const DeviceRoute&) = delete;
  DeviceRoute& operator=(const DeviceRoute&) = delete;

  /// Displacement under a load, and Fields' state of it, with f - K u if `balance`. Returns
  /// iterations.
  virtual int solve(const Load& load, bool balance) = 0;
  /// Of the last solve, where the route has it for less than correct() costs.
  [[nodiscard]] virtual std::optional<EnergyBound> energy_bound() const { return std::nullopt; }
  /// How many bases there have been.
  [[nodiscard]] virtual int bases() const { return 1; }
  /// Correction = A^-1 r with grips at 0, and Fields' summary of it. Returns iterations.
  virtual int correct() = 0;
  /// Displacement += correction, and Fields' state anew.
  virtual void add_correction() = 0;
  /// Follows an event; `destroyed`: all that are destroyed now, this event's included.
  virtual void destroy(std::span<const Index> elements, std::span<const Index> destroyed) = 0;
  /// Called when refinement failed. True: the route started afresh, solve anew.
  [[nodiscard]] virtual bool restart(std::span<const Index> destroyed) = 0;

  /// L with L L^T = (A^-1)_GG of the gripped unknowns, a lower triangle; null: the route has none.
  [[nodiscard]] virtual const Eigen::MatrixXd* grip_factor() const { return nullptr; }

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string update() const = 0;
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
  /// Device time of the last solve() and what followed it.
  [[nodiscard]] virtual std::vector<vulkan::PassTime> pass_times() const = 0;
};

}  // namespace sunder::gpu
