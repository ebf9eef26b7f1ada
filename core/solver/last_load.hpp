// SPDX-License-Identifier: Apache-2.0
// The load of the last solve: within a cascade it stays what it was.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/base.hpp"

namespace sunder::solver {

class LastLoad {
 public:
  void reserve(std::size_t forces) {
    dofs_.reserve(forces);
    values_.reserve(forces);
  }
  /// Takes a load; returns false when it is the one taken before.
  bool take(const Forces& forces) {
    const bool same = known_ && std::ranges::equal(forces.dofs, dofs_) &&
                      std::ranges::equal(forces.values, values_);
    if (same) return false;
    dofs_.assign(forces.dofs.begin(), forces.dofs.end());
    values_.assign(forces.values.begin(), forces.values.end());
    known_ = true;
    return true;
  }
  /// The next load is another one.
  void forget() { known_ = false; }
  [[nodiscard]] bool known() const { return known_; }
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }
  [[nodiscard]] std::span<const double> values() const { return values_; }

 private:
  bool known_ = false;
  std::vector<Index> dofs_;
  std::vector<double> values_;
};

}  // namespace sunder::solver
