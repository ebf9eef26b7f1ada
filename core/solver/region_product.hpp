// SPDX-License-Identifier: Apache-2.0
// Products of route condensed's X_SS with forces on few of its unknowns, by whoever can read the
// columns faster than the host: what damage makes a frame read of X_SS.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sunder/types.hpp"

namespace sunder::solver {

class CondensedBase;

class RegionProduct {
 public:
  RegionProduct() = default;
  RegionProduct(const RegionProduct&) = delete;
  RegionProduct& operator=(const RegionProduct&) = delete;
  virtual ~RegionProduct() = default;

  /// Another base comes, or one goes back: nothing is known of its columns.
  virtual void begin(const CondensedBase& base) = 0;
  /// S is its first `unknowns` again.
  virtual void forget(Index unknowns) = 0;
  /// Takes columns of X_SS that it lacks, those at these places of S first, as many as there is
  /// time for. False: they are too few to be worth a product.
  virtual bool follow(const CondensedBase& base, std::span<const Index> places) = 0;
  [[nodiscard]] virtual bool has(Index place) const = 0;
  /// Places that a product takes at most.
  [[nodiscard]] virtual std::size_t most() const = 0;
  /// u += these columns times values, in the first rows() unknowns of S; it has them all.
  virtual void add(std::span<const Index> places, std::span<const double> values,
                   Eigen::VectorXd& u) = 0;
  /// Those that S began with: what it has grown by is the host's.
  [[nodiscard]] virtual Index rows() const = 0;
};

}  // namespace sunder::solver
