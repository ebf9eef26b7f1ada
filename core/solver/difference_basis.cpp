// SPDX-License-Identifier: Apache-2.0
#include "solver/difference_basis.hpp"

#include <algorithm>

namespace sunder::solver {
namespace {

constexpr unsigned kAllCorners = 15;

}  // namespace

DifferenceBasis::DifferenceBasis(const Problem& problem)
    : problem_(problem),
      ground_(problem.dof_count()),
      parent_(static_cast<std::size_t>(ground_) + 1, kNone),
      edge_(parent_.size(), kNone),
      below_(parent_.size(), 0) {
  differences_.reserve(1024);
  marked_.reserve(1024);
  order_.reserve(1024);
}

std::array<Index, 4> DifferenceBasis::vertices(const Corners& corners, int axis) const {
  std::array<Index, 4> vertices;
  for (std::size_t a = 0; a < 4; ++a) {
    const Index d = problem_.dof(corners[a], axis);
    vertices[a] = d == kNone ? ground_ : d;
  }
  return vertices;
}

Index DifferenceBasis::root(Index vertex) const {
  while (parent_[vertex] != kNone) vertex = parent_[vertex];
  return vertex;
}

/// Hangs b's tree under a.
void DifferenceBasis::connect(Index a, Index b, Index difference) {
  Index above = a, edge = difference;
  for (Index v = b; v != kNone;) {
    const Index next = parent_[v], next_edge = edge_[v];
    parent_[v] = above;
    edge_[v] = edge;
    above = v;
    edge = next_edge;
    v = next;
  }
}

void DifferenceBasis::add(const Corners& corners) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto v = vertices(corners, axis);
    for (std::size_t a = 1; a < 4; ++a) {
      if (root(v[a]) == root(v[0])) continue;
      const auto difference = static_cast<Index>(differences_.size());
      if (v[a] == ground_) {
        differences_.push_back({v[0], kNone});
      } else {
        differences_.push_back({v[a], v[0] == ground_ ? kNone : v[0]});
      }
      connect(v[0], v[a], difference);
    }
  }
}

void DifferenceBasis::shrink(std::size_t count) {
  for (const Difference& d : differences_) {
    const Index other = d.other == kNone ? ground_ : d.other;
    parent_[d.dof] = parent_[other] = edge_[d.dof] = edge_[other] = kNone;
  }
  differences_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Difference& d = differences_[i];
    connect(d.other == kNone ? ground_ : d.other, d.dof, static_cast<Index>(i));
  }
}

void DifferenceBasis::coordinates(Index element, std::vector<Index>& rows,
                                  linear_algebra::RowMajor& u) {
  coordinates(problem_.mesh().tets[element], fem::update_factor(problem_, element), rows, u);
}

void DifferenceBasis::coordinates(const Corners& corners, const fem::UpdateFactor& forces,
                                  std::vector<Index>& rows, linear_algebra::RowMajor& u) {
  rows.clear();
  for (int axis = 0; axis < 3; ++axis) {
    const auto v = vertices(corners, axis);
    marked_.clear();
    order_.clear();
    for (unsigned a = 0; a < 4; ++a) {
      for (Index x = v[a]; parent_[x] != kNone; x = parent_[x]) {
        if (below_[x] == 0) marked_.push_back(x);
        below_[x] = static_cast<std::uint8_t>(below_[x] | (1U << a));
      }
    }
    for (Index x : marked_) {
      if (below_[x] != kAllCorners) order_.emplace_back(edge_[x], x);
    }
    std::sort(order_.begin(), order_.end());
    if (u.rows() < static_cast<Eigen::Index>(rows.size() + order_.size()) || u.cols() < 8) {
      u.conservativeResize(2 * static_cast<Eigen::Index>(rows.size() + order_.size()) + 64,
                           std::max<Eigen::Index>(u.cols(), 8));
    }
    for (const auto& [difference, under] : order_) {
      // What the side of `dof` exerts on the other: the same sum whatever hangs under what.
      const unsigned side =
          differences_[difference].dof == under ? below_[under] : kAllCorners - below_[under];
      auto row = u.row(static_cast<Eigen::Index>(rows.size())).head<8>();
      row.setZero();
      for (int a = 0; a < 4; ++a) {
        if (side >> a & 1U) row.head<6>() += forces.row(3 * a + axis);
      }
      rows.push_back(difference);
    }
    for (Index x : marked_) below_[x] = 0;
  }
}

}  // namespace sunder::solver
