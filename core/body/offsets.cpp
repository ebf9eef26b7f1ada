// SPDX-License-Identifier: Apache-2.0
#include "body/offsets.hpp"

#include <algorithm>

namespace sunder::fem {

void Offsets::follow(const Forms& forms) {
  const auto all = forms.new_nodes();
  const auto same = [](const NewNode& a, const NewNode& b) {
    return a.parent == b.parent && a.axes == b.axes;
  };
  const bool grown =
      all.size() >= nodes_.size() && std::equal(nodes_.begin(), nodes_.end(), all.begin(), same);
  if (!grown) *this = {};  // an event was taken back
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].tie = all[i].tie;
    nodes_[i].spring = all[i].spring;
  }
  for (std::size_t i = nodes_.size(); i < all.size(); ++i) {
    nodes_.push_back(all[i]);
    auto& own = unknowns_.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      own[static_cast<std::size_t>(axis)] = all[i].axes.has(axis) ? count_++ : kNone;
    }
  }
}

void Offsets::move(std::span<const double> d, std::span<double> nodal) const {
  double* at = nodal.data() + nodal.size() - 3 * nodes_.size();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis, ++at) {
      const Index own = unknowns_[i][axis];
      *at = nodal[3 * static_cast<std::size_t>(nodes_[i].parent) + axis] +
            (own == kNone ? 0.0 : d[static_cast<std::size_t>(own)]);
    }
  }
}

void Offsets::gather(std::span<const double> nodal, std::span<const double> d,
                     std::span<double> forces) const {
  const double* at = nodal.data() + nodal.size() - 3 * nodes_.size();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const NewNode& node = nodes_[i];
    double pressed = 0;  // the spring's length, times the root of its stiffness
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Index own = unknowns_[i][axis];
      if (own == kNone) continue;
      pressed += node.spring[static_cast<Eigen::Index>(axis)] * d[static_cast<std::size_t>(own)];
    }
    for (std::size_t axis = 0; axis < 3; ++axis, ++at) {
      const Index own = unknowns_[i][axis];
      if (own == kNone) continue;
      const auto o = static_cast<std::size_t>(own);
      forces[o] = *at + node.tie * d[o] + node.spring[static_cast<Eigen::Index>(axis)] * pressed;
    }
  }
}

}  // namespace sunder::fem
