// SPDX-License-Identifier: Apache-2.0
// The product of route condensed's columns X_SS B with a vector, by whoever can read them faster
// than the host: what damage makes a frame read of X_SS.
#pragma once

#include <Eigen/Core>

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
  virtual void begin() = 0;
  /// Columns from `count` on are gone.
  virtual void forget(Index count) = 0;
  /// Takes columns that are new, as many as there is time for. Returns how many of the first
  /// ones add() multiplies; the rest is the host's.
  virtual Index follow(const CondensedBase& base) = 0;
  /// u += these columns times c, in the first rows() unknowns of S.
  virtual void add(const Eigen::VectorXd& c, Eigen::VectorXd& u) = 0;
  /// Those that S began with: what it has grown by is the host's.
  [[nodiscard]] virtual Index rows() const = 0;
};

}  // namespace sunder::solver
