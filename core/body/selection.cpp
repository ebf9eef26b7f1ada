// SPDX-License-Identifier: Apache-2.0
#include "body/selection.hpp"

#include <algorithm>
#include <cmath>

#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

void sort_unique(std::vector<Index>& ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

std::vector<Index> checked_ids(std::vector<Index> ids, Index count, const char* kind,
                               const std::string& what) {
  for (Index i : ids) {
    if (i < 0 || i >= count) {
      throw InputError(InputFault::bad_id, what + " names " + kind + " " + std::to_string(i) +
                                               ", but the mesh has " + kind + "s 0 to " +
                                               std::to_string(count - 1));
    }
  }
  sort_unique(ids);
  return ids;
}

bool inside(const Box& box, const Vec3& x) {
  return (x.array() >= box.min.array()).all() && (x.array() <= box.max.array()).all();
}

void check_box(const Box& box, const std::string& what) {
  if (!box.min.allFinite() || !box.max.allFinite() || !(box.min.array() <= box.max.array()).all()) {
    throw InputError(InputFault::out_of_range,
                     what + " has a box whose minimum is not below its maximum on every axis");
  }
}

void check_ball(const Ball& ball, const std::string& what) {
  if (!ball.center.allFinite() || !(ball.radius >= 0) || !std::isfinite(ball.radius)) {
    throw InputError(InputFault::out_of_range,
                     what + " has a center or radius that is not finite or is negative");
  }
}

template <class Predicate>
std::vector<Index> ids_where(Index count, Predicate&& predicate) {
  std::vector<Index> ids;
  for (Index i = 0; i < count; ++i) {
    if (predicate(i)) ids.push_back(i);
  }
  return ids;
}

/// A place selects no node that belongs to no element.
template <class Predicate>
std::vector<Index> used_where(const Mesh& mesh, Predicate&& predicate) {
  std::vector<Index> ids = ids_where(mesh.node_count(), predicate);
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  std::erase_if(ids, [&](Index n) { return !used[n]; });
  return ids;
}

std::vector<Index> nodes_of_surface(const Mesh& mesh, const std::string& name,
                                    const std::string& what) {
  const auto it = std::find_if(mesh.surfaces.begin(), mesh.surfaces.end(),
                               [&](const NamedSurface& s) { return s.name == name; });
  if (it == mesh.surfaces.end()) {
    std::vector<std::string> known;
    for (const NamedSurface& s : mesh.surfaces) known.push_back(s.name);
    throw InputError(InputFault::unknown_name,
                     what + " names surface " + in_quotes(name) + ", but the mesh has " +
                         (known.empty() ? "no named surfaces" : "only " + name_list(known)));
  }
  std::vector<Index> ids;
  for (const auto& t : it->triangles) ids.insert(ids.end(), t.begin(), t.end());
  sort_unique(ids);
  const std::vector<std::uint8_t> used = used_nodes(mesh);
  std::erase_if(ids, [&](Index n) { return !used[n]; });
  return ids;
}

std::vector<Index> elements_of_volume(const Mesh& mesh, const std::string& name,
                                      const std::string& what) {
  const auto it = std::find_if(mesh.volumes.begin(), mesh.volumes.end(),
                               [&](const NamedVolume& v) { return v.name == name; });
  if (it == mesh.volumes.end()) {
    std::vector<std::string> known;
    for (const NamedVolume& v : mesh.volumes) known.push_back(v.name);
    throw InputError(InputFault::unknown_name, what + " names volume " + in_quotes(name) +
                                                   ", but the mesh has only " + name_list(known));
  }
  const Index volume = static_cast<Index>(it - mesh.volumes.begin());
  return ids_where(mesh.tet_count(), [&](Index t) { return mesh.volume_of[t] == volume; });
}

Vec3 centroid(const Mesh& mesh, Index t) {
  Vec3 sum = Vec3::Zero();
  for (Index n : mesh.tets[t]) sum += mesh.nodes[n];
  return sum / 4;
}

std::vector<Index> not_empty(std::vector<Index> ids, const char* kind, const std::string& what) {
  if (ids.empty()) {
    throw InputError(InputFault::empty_selection,
                     what + " selects no " + kind + "; widen its selection");
  }
  return ids;
}

}  // namespace

std::vector<Index> select_nodes(const Mesh& mesh, const NodeSelection& selection,
                                const std::string& what) {
  std::vector<Index> ids = std::visit(
      Overloaded{
          [&](const std::vector<Index>& list) {
            return checked_ids(list, mesh.node_count(), "node", what);
          },
          [&](const Box& box) {
            check_box(box, what);
            return used_where(mesh, [&](Index n) { return inside(box, mesh.nodes[n]); });
          },
          [&](const Ball& ball) {
            check_ball(ball, what);
            return used_where(
                mesh, [&](Index n) { return (mesh.nodes[n] - ball.center).norm() <= ball.radius; });
          },
          [&](const SurfaceName& s) { return nodes_of_surface(mesh, s.name, what); },
      },
      selection);
  return not_empty(std::move(ids), "node", what);
}

std::vector<Index> select_elements(const Mesh& mesh, const ElementSelection& selection,
                                   const std::string& what) {
  std::vector<Index> ids =
      std::visit(Overloaded{
                     [&](const std::vector<Index>& list) {
                       return checked_ids(list, mesh.tet_count(), "element", what);
                     },
                     [&](const VolumeName& v) { return elements_of_volume(mesh, v.name, what); },
                     [&](const Box& box) {
                       check_box(box, what);
                       return ids_where(mesh.tet_count(),
                                        [&](Index t) { return inside(box, centroid(mesh, t)); });
                     },
                 },
                 selection);
  return not_empty(std::move(ids), "element", what);
}

}  // namespace sunder
