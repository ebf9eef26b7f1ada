// SPDX-License-Identifier: Apache-2.0
// Orders in which the board's elements are taken out: scattered over the tissue, along a crack,
// right across. A crack leaves nodes and slivers that only destroyed elements hold; scattered
// sequences do not, and are no test of stability.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::test {

inline Vec3 centroid(const Mesh& mesh, Index e) {
  Vec3 sum = Vec3::Zero();
  for (Index n : mesh.tets[e]) sum += mesh.nodes[n];
  return sum / 4;
}

/// Breakable elements in random order (fixed seed).
inline std::vector<Index> scattered_sequence(const Problem& problem, std::size_t count) {
  std::vector<Index> all;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (problem.breakable(e)) all.push_back(e);
  }
  std::mt19937 generator(20131);
  for (std::size_t i = all.size() - 1; i > 0; --i) std::swap(all[i], all[generator() % (i + 1)]);
  all.resize(count);
  return all;
}

/// Elements that the plane y = `height` cuts, by growing distance from the right edge: a crack
/// through the thickness.
inline std::vector<Index> elements_across(const Mesh& mesh, double height) {
  std::vector<Index> cut;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    double low = 1e300, high = -1e300;
    for (Index n : mesh.tets[e]) {
      low = std::min(low, mesh.nodes[n].y());
      high = std::max(high, mesh.nodes[n].y());
    }
    if (low < height && high >= height) cut.push_back(e);
  }
  std::stable_sort(cut.begin(), cut.end(),
                   [&](Index a, Index b) { return centroid(mesh, a).x() > centroid(mesh, b).x(); });
  return cut;
}

/// Breakable elements along a crack that enters at (50, 26.5) and stops at x = `end`; when the
/// row is used up, the crack widens: next are the nearest rows above and below.
inline std::vector<Index> crack_sequence(const Problem& problem, std::size_t count, double end) {
  const Mesh& mesh = problem.mesh();
  std::vector<std::uint8_t> taken(mesh.tets.size(), 0);
  std::vector<Index> sequence;
  for (double offset : {0.0, 1.5, -1.5, 3.0, -3.0, 4.5, -4.5}) {
    for (Index e : elements_across(mesh, 26.5 + offset)) {
      if (sequence.size() == count) return sequence;
      if (taken[e] || !problem.breakable(e) || centroid(mesh, e).x() < end) continue;
      taken[e] = 1;
      sequence.push_back(e);
    }
  }
  return sequence;
}

}  // namespace sunder::test
