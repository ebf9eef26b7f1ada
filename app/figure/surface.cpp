// SPDX-License-Identifier: Apache-2.0
#include "app/figure/surface.hpp"

#include <algorithm>

namespace sunder::app {
namespace {

/// Outward faces of a tetrahedron of positive volume.
constexpr std::array<std::array<int, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

struct Half {
  std::array<Index, 3> key;  ///< nodes, ascending
  Index tet;
  int face;
};

std::vector<Half> sorted_halves(const Mesh& mesh) {
  std::vector<Half> halves;
  halves.reserve(mesh.tets.size() * 4);
  for (Index e = 0; e < mesh.tet_count(); ++e)
    for (int f = 0; f < 4; ++f) {
      std::array<Index, 3> key;
      for (int i = 0; i < 3; ++i) key[i] = mesh.tets[e][kFaces[f][i]];
      std::sort(key.begin(), key.end());
      halves.push_back({key, e, f});
    }
  std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
    return a.key != b.key ? a.key < b.key : a.tet < b.tet;
  });
  return halves;
}

/// The edges that lips have in common with the rest of the surface.
void mark_rims(std::vector<BodyFace>& faces, std::size_t node_count) {
  std::vector<Edge> of_lips, rim;
  std::vector<std::uint8_t> on_lip(node_count, 0);  // few are: the rest needs no search
  for (const BodyFace& face : faces)
    for (int i = 0; face.lip && i < 3; ++i) {
      of_lips.push_back(edge(face, i));
      on_lip[face.nodes[i]] = 1;
    }
  std::sort(of_lips.begin(), of_lips.end());
  for (BodyFace& face : faces)
    for (int i = 0; !face.lip && i < 3; ++i) {
      if (!on_lip[face.nodes[i]] || !on_lip[face.nodes[(i + 1) % 3]]) continue;
      face.rim[i] = std::binary_search(of_lips.begin(), of_lips.end(), edge(face, i));
      if (face.rim[i]) rim.push_back(edge(face, i));
    }
  std::sort(rim.begin(), rim.end());
  for (BodyFace& face : faces)
    for (int i = 0; face.lip && i < 3; ++i)
      face.rim[i] = std::binary_search(rim.begin(), rim.end(), edge(face, i));
}

}  // namespace

Edge edge(const BodyFace& face, int i) {
  const auto [a, b] = std::minmax(face.nodes[i], face.nodes[(i + 1) % 3]);
  return {a, b};
}

FaceTable::FaceTable(const Mesh& mesh)
    : mesh_(mesh), neighbour_(mesh.tets.size(), {kNone, kNone, kNone, kNone}) {
  const std::vector<Half> halves = sorted_halves(mesh);
  for (std::size_t i = 1; i < halves.size(); ++i) {
    const Half &a = halves[i - 1], &b = halves[i];
    if (a.key != b.key) continue;
    neighbour_[a.tet][a.face] = b.tet;
    neighbour_[b.tet][b.face] = a.tet;
  }
}

FaceTable::FaceTable(const Mesh& split, const FaceTable& intact) : FaceTable(split) {
  intact_ = intact.neighbour_;
}

std::vector<BodyFace> FaceTable::border(std::span<const std::uint8_t> destroyed,
                                        bool of_destroyed) const {
  std::vector<BodyFace> faces;
  for (Index e = 0; e < mesh_.tet_count(); ++e) {
    if ((destroyed[e] != 0) != of_destroyed) continue;
    for (int f = 0; f < 4; ++f) {
      const Index other = neighbour_[e][f];
      if (other != kNone && (destroyed[other] != 0) == of_destroyed) continue;
      BodyFace face{{}, e};
      for (int i = 0; i < 3; ++i) face.nodes[i] = mesh_.tets[e][kFaces[f][i]];
      face.lip = other != kNone || (!intact_.empty() && intact_[e][f] != kNone);
      faces.push_back(face);
    }
  }
  return faces;
}

std::vector<BodyFace> FaceTable::surface(std::span<const std::uint8_t> destroyed) const {
  std::vector<BodyFace> faces = border(destroyed, false);
  mark_rims(faces, mesh_.nodes.size());
  return faces;
}

std::vector<BodyFace> FaceTable::removed(std::span<const std::uint8_t> destroyed) const {
  return border(destroyed, true);
}

}  // namespace sunder::app
