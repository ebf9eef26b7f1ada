// SPDX-License-Identifier: Apache-2.0
// What a frame whose solution is on the host (host_frame.hpp) asks of its fields.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "solver/region.hpp"

namespace sunder::solver {

class HostFields {
 public:
  HostFields() = default;
  HostFields(const HostFields&) = delete;
  HostFields& operator=(const HostFields&) = delete;
  virtual ~HostFields() = default;

  /// What a frame computes alone; null: all of the body.
  [[nodiscard]] virtual const Region* region() const = 0;
  /// Of the last finished solution, at some nodes [mm].
  virtual void read_displacement(std::span<const Index> nodes,
                                 std::span<Vec3> displacement) const = 0;
  /// Takes the displacement in work, over all unknowns, and computes its stress. Returns the
  /// largest over live elements [MPa]; nothing: nobody needs stress.
  virtual std::optional<double> take(const Eigen::VectorXd& u) = 0;
  /// K u of the displacement in work, where the fields have it with the stress; else body by body.
  [[nodiscard]] virtual bool has_forces() const { return false; }
  virtual void forces(Eigen::VectorXd&) {}
  /// Largest stress over live elements of another displacement; of fields that have forces.
  [[nodiscard]] virtual double largest_stress(const Eigen::VectorXd&) { return 0; }
};

}  // namespace sunder::solver
