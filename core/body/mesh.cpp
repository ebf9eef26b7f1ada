// SPDX-License-Identifier: Apache-2.0
#include "sunder/mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

// Corner opposite to face i is i; node order gives an outward normal for positive volume.
constexpr std::array<std::array<int, 3>, 4> kFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// 6 V below this share of the longest edge's cube is a zero-volume element: coordinates of double
// precision leave no digit in its shape. A sliver of quality 1e-4 is eight decades above it.
constexpr double kZeroVolume = 1e-13;

struct Face {
  std::array<Index, 3> key;
  Index tet;
  int local;
};

std::vector<Face> sorted_faces(const Mesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(mesh.tets.size() * 4);
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    for (int f = 0; f < 4; ++f) {
      std::array<Index, 3> key;
      for (int i = 0; i < 3; ++i) key[i] = mesh.tets[t][kFaces[f][i]];
      std::sort(key.begin(), key.end());
      faces.push_back({key, t, f});
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.key != b.key ? a.key < b.key : a.tet < b.tet;
  });
  return faces;
}

[[noreturn]] void fail(InputFault fault, const std::string& where, const std::string& what) {
  throw InputError(fault, where + ": " + what);
}

void validate_nodes(const Mesh& mesh, const std::string& where) {
  for (Index n = 0; n < mesh.node_count(); ++n) {
    if (!mesh.nodes[n].allFinite()) {
      fail(InputFault::out_of_range, where,
           "node " + std::to_string(n) + " has a coordinate that is not a finite number");
    }
  }
}

/// (x1-x0) x (x2-x0) . (x3-x0)
double six_volumes(const Mesh& mesh, const std::array<Index, 4>& tet) {
  const Vec3& x0 = mesh.nodes[tet[0]];
  return (mesh.nodes[tet[1]] - x0).cross(mesh.nodes[tet[2]] - x0).dot(mesh.nodes[tet[3]] - x0);
}

void validate_tet(const Mesh& mesh, Index t, const std::string& where) {
  const auto& tet = mesh.tets[t];
  const std::string name = "element " + std::to_string(t);
  for (Index n : tet) {
    if (n < 0 || n >= mesh.node_count()) {
      fail(InputFault::bad_id, where,
           name + " names node " + std::to_string(n) + ", but the mesh has nodes 0 to " +
               std::to_string(mesh.node_count() - 1));
    }
  }
  double longest = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      longest = std::max(longest, (mesh.nodes[tet[i]] - mesh.nodes[tet[j]]).norm());
    }
  }
  const double six_v = six_volumes(mesh, tet);
  if (!(std::abs(six_v) > kZeroVolume * longest * longest * longest)) {
    fail(InputFault::degenerate_element, where,
         name + " has zero volume; remove it or mend the mesh");
  }
  if (six_v < 0) {
    fail(InputFault::inverted_element, where,
         name + " is inverted (negative volume); swap two of its nodes");
  }
}

void validate_volumes(const Mesh& mesh, const std::string& where) {
  std::set<std::string> names;
  for (const NamedVolume& v : mesh.volumes) {
    if (!names.insert(v.name).second) {
      fail(InputFault::duplicate_name, where,
           "volume " + in_quotes(v.name) + " is named twice; give every volume a name of its own");
    }
  }
  if (mesh.volume_of.size() != mesh.tets.size()) {
    fail(InputFault::bad_id, where, "every element needs the volume that it belongs to");
  }
  const Index count = static_cast<Index>(mesh.volumes.size());
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    if (mesh.volume_of[t] < 0 || mesh.volume_of[t] >= count) {
      fail(InputFault::bad_id, where,
           "element " + std::to_string(t) + " belongs to volume " +
               std::to_string(mesh.volume_of[t]) + ", but there are " + std::to_string(count));
    }
  }
}

void validate_surfaces(const Mesh& mesh, const std::string& where) {
  for (const NamedSurface& s : mesh.surfaces) {
    for (const auto& triangle : s.triangles) {
      for (Index n : triangle) {
        if (n < 0 || n >= mesh.node_count()) {
          fail(InputFault::bad_id, where,
               "surface " + in_quotes(s.name) + " names node " + std::to_string(n) +
                   ", which the mesh does not have");
        }
      }
    }
  }
}

}  // namespace

std::vector<FreeFace> free_faces(const Mesh& mesh) {
  const std::vector<Face> faces = sorted_faces(mesh);
  std::vector<Face> single;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t j = i + 1;
    while (j < faces.size() && faces[j].key == faces[i].key) ++j;
    if (j == i + 1) single.push_back(faces[i]);
    i = j;
  }
  std::sort(single.begin(), single.end(), [](const Face& a, const Face& b) {
    return a.tet != b.tet ? a.tet < b.tet : a.local < b.local;
  });
  std::vector<FreeFace> result;
  result.reserve(single.size());
  for (const Face& f : single) {
    const auto& tet = mesh.tets[f.tet];
    const auto& local = kFaces[f.local];
    result.push_back({{tet[local[0]], tet[local[1]], tet[local[2]]}, f.tet});
  }
  return result;
}

void validate(const Mesh& mesh, const std::string& where) {
  if (mesh.tets.empty()) {
    fail(InputFault::no_tetrahedra, where, "the mesh has no tetrahedra; mesh its volumes first");
  }
  validate_nodes(mesh, where);
  for (Index t = 0; t < mesh.tet_count(); ++t) validate_tet(mesh, t, where);
  validate_volumes(mesh, where);
  validate_surfaces(mesh, where);
}

Turned turn_inverted(Mesh& mesh) {
  Turned turned;
  for (Index t = 0; t < mesh.tet_count(); ++t) {
    auto& tet = mesh.tets[t];
    if (!std::all_of(tet.begin(), tet.end(),
                     [&](Index n) { return n >= 0 && n < mesh.node_count(); })) {
      continue;
    }
    if (!(six_volumes(mesh, tet) < 0)) continue;
    std::swap(tet[2], tet[3]);
    if (turned.count++ == 0) turned.first = t;
  }
  return turned;
}

std::string sentence(const Turned& turned) {
  return count_of(turned.count, "element of negative volume was",
                  "elements of negative volume were") +
         " turned: two corners swapped (first: element " + std::to_string(turned.first) + ")";
}

std::vector<std::uint8_t> used_nodes(const Mesh& mesh) {
  std::vector<std::uint8_t> used(mesh.nodes.size(), 0);
  for (const auto& tet : mesh.tets) {
    for (Index n : tet) used[n] = 1;
  }
  return used;
}

Index drop_unused_nodes(Mesh& mesh) {
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  std::vector<Index> id(mesh.nodes.size(), kNone);
  Index kept = 0;
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (!used[n]) continue;
    mesh.nodes[kept] = mesh.nodes[n];
    id[n] = kept++;
  }
  const Index dropped = mesh.node_count() - kept;
  mesh.nodes.resize(kept);
  for (auto& tet : mesh.tets) {
    for (Index& n : tet) n = id[n];
  }
  for (NamedSurface& s : mesh.surfaces) {
    std::erase_if(s.triangles, [&](const std::array<Index, 3>& t) {
      return std::any_of(t.begin(), t.end(), [&](Index n) { return id[n] == kNone; });
    });
    for (auto& triangle : s.triangles) {
      for (Index& n : triangle) n = id[n];
    }
  }
  return dropped;
}

}  // namespace sunder
