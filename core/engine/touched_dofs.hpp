// SPDX-License-Identifier: Apache-2.0
// The unknowns that a stack of blocks touches, each listed once.
#pragma once

#include <span>
#include <vector>

#include "sunder/types.hpp"

namespace sunder::engine {

class TouchedDofs {
 public:
  explicit TouchedDofs(Index unknowns) : place_(static_cast<std::size_t>(unknowns), kNone) {}

  /// Adds unknowns; returns the place of each in list().
  std::vector<Index> push(std::span<const Index> dofs) {
    counts_.push_back(list_.size());
    std::vector<Index> places;
    places.reserve(dofs.size());
    for (Index d : dofs) {
      if (place_[d] == kNone) {
        place_[d] = static_cast<Index>(list_.size());
        list_.push_back(d);
      }
      places.push_back(place_[d]);
    }
    return places;
  }
  /// Takes back the last push.
  void pop() {
    for (std::size_t i = counts_.back(); i < list_.size(); ++i) place_[list_[i]] = kNone;
    list_.resize(counts_.back());
    counts_.pop_back();
  }
  [[nodiscard]] std::span<const Index> list() const { return list_; }
  [[nodiscard]] Index size() const { return static_cast<Index>(list_.size()); }

 private:
  std::vector<Index> place_;  // kNone: not touched
  std::vector<Index> list_;
  std::vector<std::size_t> counts_;  // before each push
};

}  // namespace sunder::engine
