// SPDX-License-Identifier: Apache-2.0
#include "body/mesh_findings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>

namespace sunder {
namespace {

constexpr double kSamePlace = 1e-3;  // of the shortest edge

constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Sets of nodes with what they belong to, those of one smallest node side by side and sorted:
/// a counting sort by that node, then small sorts, so that a million elements take tenths of a
/// second.
template <std::size_t kSize>
struct NodeSets {
  struct Entry {
    std::array<Index, kSize> nodes;  // ascending
    Index owner;
  };
  std::vector<Entry> entries;

  void sort(std::size_t node_count) {
    std::vector<std::size_t> begin(node_count + 1, 0);
    for (const Entry& e : entries) ++begin[static_cast<std::size_t>(e.nodes[0]) + 1];
    for (std::size_t n = 0; n < node_count; ++n) begin[n + 1] += begin[n];
    std::vector<Entry> sorted(entries.size());
    std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
    for (const Entry& e : entries) sorted[next[static_cast<std::size_t>(e.nodes[0])]++] = e;
    const auto at = [&](std::size_t i) { return sorted.begin() + static_cast<std::ptrdiff_t>(i); };
    for (std::size_t n = 0; n < node_count; ++n) {
      std::sort(at(begin[n]), at(begin[n + 1]), [](const Entry& a, const Entry& b) {
        return a.nodes != b.nodes ? a.nodes < b.nodes : a.owner < b.owner;
      });
    }
    entries = std::move(sorted);
  }

  /// Calls body(first, behind) for each run of entries with the same nodes.
  template <class Body>
  void for_runs(Body&& body) const {
    for (std::size_t i = 0; i < entries.size();) {
      std::size_t j = i + 1;
      while (j < entries.size() && entries[j].nodes == entries[i].nodes) ++j;
      body(i, j);
      i = j;
    }
  }
};

template <std::size_t kSize>
std::array<Index, kSize> ascending(std::array<Index, kSize> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

std::array<Index, 3> face_nodes(const Mesh& mesh, Index e, std::size_t face) {
  std::array<Index, 3> nodes{};
  for (std::size_t i = 0; i < 3; ++i)
    nodes[i] = mesh.tets[static_cast<std::size_t>(e)][static_cast<std::size_t>(kFaces[face][i])];
  return ascending(nodes);
}

Index root_of(std::vector<Index>& parent, Index i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    Index& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

/// The smaller root stays, so that roots are the first of their set.
void join(std::vector<Index>& parent, Index a, Index b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

double shortest_edge(const Mesh& mesh) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& tet : mesh.tets) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j)
        shortest = std::min(shortest, (mesh.nodes[tet[i]] - mesh.nodes[tet[j]]).squaredNorm());
    }
  }
  return std::sqrt(shortest);
}

/// Nodes by the cell of a cubic lattice; cells of one key are told apart by the distance asked for.
class Lattice {
 public:
  Lattice(const Mesh& mesh, const std::vector<std::uint8_t>& used, double cell)
      : mesh_(mesh), cell_(cell) {
    for (Index n = 0; n < mesh.node_count(); ++n)
      if (used[n]) keys_.emplace_back(key(mesh.nodes[n], 0, 0), n);
    std::sort(keys_.begin(), keys_.end());
  }

  /// The first node within `radius` of node n (radius at most half a cell); n itself at the latest.
  [[nodiscard]] Index first_beside(Index n, double radius) const {
    const Vec3& x = mesh_.nodes[n];
    Index first = n;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const std::uint64_t wanted = key(x, corner, radius);
      if (corner > 0 && wanted == key(x, 0, radius)) continue;  // nearly always
      auto it = std::lower_bound(keys_.begin(), keys_.end(), std::pair(wanted, Index{0}));
      for (; it != keys_.end() && it->first == wanted && it->second < first; ++it)
        if ((mesh_.nodes[it->second] - x).norm() <= radius) first = it->second;
    }
    return first;
  }

 private:
  /// Of the cell that a corner of the cube with half side `radius` lies in.
  [[nodiscard]] std::uint64_t key(const Vec3& x, unsigned corner, double radius) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = x[axis] + ((corner >> static_cast<unsigned>(axis) & 1U) ? radius : -radius);
      const auto index = static_cast<std::int64_t>(std::floor(at / cell_));
      hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15U;  // 2^64/golden ratio
      hash ^= hash >> 29U;
    }
    return hash;
  }

  const Mesh& mesh_;
  double cell_;
  std::vector<std::pair<std::uint64_t, Index>> keys_;
};

/// Per node the first one in its place; empty when every used node has a place of its own.
std::vector<Index> first_in_place(const Mesh& mesh) {
  const double radius = kSamePlace * shortest_edge(mesh);
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  const Lattice lattice(mesh, used, 64 * radius);  // most spheres lie in one cell
  std::vector<Index> first(mesh.nodes.size());
  std::iota(first.begin(), first.end(), 0);
  bool any = false;
  for (Index n = 0; n < mesh.node_count(); ++n) {
    if (used[n]) first[n] = first[lattice.first_beside(n, radius)];
    any = any || first[n] != n;
  }
  if (!any) first.clear();
  return first;
}

/// Two free faces in one place.
struct FacePair {
  Index a, b;                  // elements, ascending
  std::array<Index, 3> at;     // places
  std::array<Index, 6> nodes;  // of both
};

struct SingleFace {
  std::array<Index, 3> nodes;
  Index element;
};

/// Faces of one element only, of those beside a node that shares its place.
std::vector<SingleFace> single_faces(const Mesh& mesh, const std::vector<Index>& place) {
  std::vector<std::uint8_t> shared(place.size(), 0);
  for (std::size_t n = 0; n < place.size(); ++n)
    if (place[n] != static_cast<Index>(n)) shared[n] = shared[place[n]] = 1;
  NodeSets<3> faces;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    for (std::size_t f = 0; f < 4; ++f) {
      const auto nodes = face_nodes(mesh, e, f);
      if (std::any_of(nodes.begin(), nodes.end(), [&](Index n) { return shared[n] != 0; }))
        faces.entries.push_back({nodes, e});
    }
  }
  faces.sort(place.size());
  std::vector<SingleFace> single;
  faces.for_runs([&](std::size_t i, std::size_t j) {
    if (j == i + 1) single.push_back({faces.entries[i].nodes, faces.entries[i].owner});
  });
  return single;
}

std::vector<FacePair> faces_in_one_place(const Mesh& mesh, const std::vector<Index>& place) {
  const std::vector<SingleFace> single = single_faces(mesh, place);
  NodeSets<3> places;
  for (std::size_t i = 0; i < single.size(); ++i) {
    auto at = single[i].nodes;
    for (Index& n : at) n = place[n];
    places.entries.push_back({ascending(at), static_cast<Index>(i)});
  }
  places.sort(place.size());
  std::vector<FacePair> pairs;
  places.for_runs([&](std::size_t i, std::size_t j) {
    for (std::size_t k = i + 1; k < j; ++k) {
      const SingleFace& a = single[places.entries[i].owner];
      const SingleFace& b = single[places.entries[k].owner];
      FacePair pair{std::min(a.element, b.element),
                    std::max(a.element, b.element),
                    places.entries[i].nodes,
                    {}};
      std::copy(a.nodes.begin(), a.nodes.end(), pair.nodes.begin());
      std::copy(b.nodes.begin(), b.nodes.end(), pair.nodes.begin() + 3);
      pairs.push_back(pair);
    }
  });
  return pairs;
}

/// The connected cuts (by root node) that have a declared point beside them.
std::vector<Index> declared_cuts(const Mesh& mesh, const std::vector<FacePair>& pairs,
                                 std::vector<Index>& parent, std::span<const Vec3> declared,
                                 const Vec3& normal) {
  std::map<Index, double> longest;  // edge of a cut
  for (const FacePair& p : pairs) {
    double& edge = longest[root_of(parent, p.at[0])];
    for (std::size_t i = 0; i < 3; ++i)
      edge = std::max(edge, (mesh.nodes[p.at[i]] - mesh.nodes[p.at[(i + 1) % 3]]).norm());
  }
  std::vector<Index> cuts;
  for (const FacePair& p : pairs) {
    const Index cut = root_of(parent, p.at[0]);
    if (!cuts.empty() && cuts.back() == cut) continue;
    for (Index n : p.at) {
      const bool beside = std::any_of(declared.begin(), declared.end(), [&](const Vec3& x) {
        const Vec3 d = mesh.nodes[n] - x;
        return (d - d.dot(normal) * normal).norm() <= longest[cut];
      });
      if (!beside) continue;
      cuts.push_back(cut);
      break;
    }
  }
  return cuts;
}

}  // namespace

DuplicateElements find_duplicates(const Mesh& mesh) {
  NodeSets<4> sets;
  sets.entries.reserve(mesh.tets.size());
  for (Index e = 0; e < mesh.tet_count(); ++e)
    sets.entries.push_back({ascending(mesh.tets[static_cast<std::size_t>(e)]), e});
  sets.sort(mesh.nodes.size());
  DuplicateElements found;
  sets.for_runs([&](std::size_t i, std::size_t j) {
    if (j == i + 1) return;
    found.count += static_cast<Index>(j - i - 1);
    const Index second = sets.entries[i + 1].owner;
    if (found.first != kNone && found.first < second) return;
    found.first = second;
    found.of = sets.entries[i].owner;
  });
  return found;
}

HiddenCut find_hidden_cut(const Mesh& mesh, std::span<const Vec3> declared, const Vec3& normal) {
  const std::vector<Index> place = first_in_place(mesh);
  if (place.empty()) return {};
  const std::vector<FacePair> pairs = faces_in_one_place(mesh, place);
  std::vector<Index> parent(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const FacePair& p : pairs) {
    join(parent, p.at[0], p.at[1]);
    join(parent, p.at[0], p.at[2]);
  }
  std::vector<Index> cracks = declared_cuts(mesh, pairs, parent, declared, normal);
  std::sort(cracks.begin(), cracks.end());
  HiddenCut cut;
  std::vector<Index> repeated;
  for (const FacePair& p : pairs) {
    if (std::binary_search(cracks.begin(), cracks.end(), root_of(parent, p.at[0]))) continue;
    ++cut.faces;
    for (Index n : p.nodes)
      if (place[n] != n) repeated.push_back(n);
    if (cut.element != kNone && cut.element <= p.a) continue;
    cut.element = p.a;
    cut.other = p.b;
    cut.place = (mesh.nodes[p.at[0]] + mesh.nodes[p.at[1]] + mesh.nodes[p.at[2]]) / 3;
  }
  std::sort(repeated.begin(), repeated.end());
  cut.nodes = static_cast<Index>(std::unique(repeated.begin(), repeated.end()) - repeated.begin());
  return cut;
}

FaceParts find_face_parts(const Mesh& mesh) {
  NodeSets<3> faces;
  faces.entries.reserve(4 * mesh.tets.size());
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    for (std::size_t f = 0; f < 4; ++f) faces.entries.push_back({face_nodes(mesh, e, f), e});
  }
  faces.sort(mesh.nodes.size());
  std::vector<Index> parent(mesh.tets.size());
  std::iota(parent.begin(), parent.end(), 0);
  faces.for_runs([&](std::size_t i, std::size_t j) {
    for (std::size_t k = i + 1; k < j; ++k)
      join(parent, faces.entries[i].owner, faces.entries[k].owner);
  });
  FaceParts parts;
  parts.part_of_element.assign(mesh.tets.size(), kNone);
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const Index root = root_of(parent, e);
    if (root == e) parts.part_of_element[static_cast<std::size_t>(e)] = parts.count++;
    parts.part_of_element[static_cast<std::size_t>(e)] =
        parts.part_of_element[static_cast<std::size_t>(root)];
  }
  return parts;
}

}  // namespace sunder
