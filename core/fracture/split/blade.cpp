// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/blade.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <utility>

#include "body/triangle_crossing.hpp"
#include "fracture/crack_path.hpp"

namespace sunder::fracture {
namespace {

using Triangle = std::array<Vec3, 3>;

constexpr std::size_t kCrumb =
    12;                         // elements: fewer that the blade passes through stay where they are
constexpr double kEdge = 1e-9;  // share of a triangle: what meets its edge meets it

/// Whether two triangles run along a shared edge in the same direction; nothing: they share none.
std::optional<bool> runs_alike(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 &from = a[i], &to = a[(i + 1) % 3], &other = b[j], &end = b[(j + 1) % 3];
      if (from == other && to == end) return true;
      if (from == end && to == other) return false;
    }
  }
  return std::nullopt;
}

Vec3 normal_of(const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

/// The triangles, turned so that their normals are on one side of the blade.
std::vector<Triangle> turned_alike(std::span<const Triangle> blade) {
  std::vector<Triangle> turned;
  for (Triangle t : blade) {
    std::optional<bool> alike;
    for (std::size_t i = turned.size(); i-- > 0 && !alike;) alike = runs_alike(turned[i], t);
    if (!alike && !turned.empty()) alike = normal_of(turned.back()).dot(normal_of(t)) < 0;
    if (alike.value_or(false)) std::swap(t[1], t[2]);
    turned.push_back(t);
  }
  return turned;
}

/// Where between a and b a triangle is met, as a share of the way; nothing: nowhere.
struct Meeting {
  double share = 0;
  bool a_in_front = false;
};
std::optional<Meeting> meets(const Triangle& t, const Vec3& a, const Vec3& b) {
  const Vec3 normal = normal_of(t);
  const double area = normal.norm();
  if (!(area > 0)) return std::nullopt;
  const double at_a = normal.dot(a - t[0]), at_b = normal.dot(b - t[0]);
  if ((at_a >= 0) == (at_b >= 0)) return std::nullopt;
  const double share = at_a / (at_a - at_b);
  const Vec3 p = a + share * (b - a);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 inside = (t[(i + 1) % 3] - t[i]).cross(p - t[i]);
    if (inside.dot(normal) < -kEdge * area * area) return std::nullopt;
  }
  return Meeting{share, at_a >= 0};
}

struct Extent {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  void add(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  [[nodiscard]] bool meets(const Extent& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// Elements as the body is deformed.
class Places {
 public:
  Places(const SplitBody& body, std::span<const Vec3> nodes) : body_(body), nodes_(nodes) {}
  [[nodiscard]] std::array<Vec3, 4> corners(Index element) const {
    std::array<Vec3, 4> corners;
    for (std::size_t a = 0; a < 4; ++a) {
      corners[a] = nodes_[static_cast<std::size_t>(body_.corners(element)[a])];
    }
    return corners;
  }
  [[nodiscard]] Vec3 centroid(Index element) const {
    const auto [a, b, c, d] = corners(element);
    return (a + b + c + d) / 4;
  }

 private:
  const SplitBody& body_;
  std::span<const Vec3> nodes_;
};

Vec3 centroid_in_mesh(const Problem& problem, Index element) {
  Vec3 sum = Vec3::Zero();
  for (Index n : problem.mesh().tets[static_cast<std::size_t>(element)]) {
    sum += problem.mesh().nodes[static_cast<std::size_t>(n)];
  }
  return sum / 4;
}

using FaceId = std::pair<Index, int>;

/// Faces that stay shut: those of a few elements that only they hold, if the blade passes through
/// all of these.
std::set<FaceId> of_crumbs(const SplitBody& body, std::span<const PassedFace> faces,
                           std::span<const std::uint8_t> gone, const auto& is_passed) {
  std::set<FaceId> opening, shut;
  for (const auto& [face, place] : faces) {
    const Face other = body.other_side(face);
    opening.insert({face.element, face.opposite});
    opening.insert({other.element, other.opposite});
  }
  std::set<Index> seen;
  for (const auto& [first, at] : opening) {
    if (seen.contains(first)) continue;
    std::vector<Index> group{first};
    for (std::size_t i = 0; i < group.size() && group.size() < kCrumb; ++i) {
      for (int f = 0; f < 4; ++f) {
        const Face face{group[i], f};
        const Index next = body.behind(face);
        if (next == kNone || body.open(face) || opening.contains({group[i], f}) ||
            gone[static_cast<std::size_t>(next)]) {
          continue;
        }
        if (std::ranges::find(group, next) == group.end()) group.push_back(next);
      }
    }
    seen.insert(group.begin(), group.end());
    if (group.size() >= kCrumb || !std::ranges::all_of(group, is_passed)) continue;
    for (Index e : group) {
      for (int f = 0; f < 4; ++f) {
        if (!opening.contains({e, f})) continue;
        const Face other = body.other_side({e, f});
        shut.insert({e, f});
        shut.insert({other.element, other.opposite});
      }
    }
  }
  return shut;
}

std::array<Vec3, 3> corners_of(const Board& board, const SplitBody& body, const Face& face) {
  std::array<Vec3, 3> corners;
  const auto nodes = body.nodes(face);
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] = board.mesh().nodes[static_cast<std::size_t>(body.in_mesh(nodes[i]))];
  }
  return corners;
}

/// Area times the unit normal that leaves the element.
Vec3 outward_area(const Board& board, const SplitBody& body, const Face& face) {
  const Triangle corners = corners_of(board, body, face);
  const Vec3 area = normal_of(corners) / 2;
  const Index opposite =
      body.in_mesh(body.corners(face.element)[static_cast<std::size_t>(face.opposite)]);
  const Vec3& apex = board.mesh().nodes[static_cast<std::size_t>(opposite)];
  return area.dot(apex - corners[0]) > 0 ? Vec3(-area) : area;
}

Vec3 area_of(const Board& board, const SplitBody& body, std::span<const PassedFace> sheet) {
  Vec3 sum = Vec3::Zero();
  for (const PassedFace& passed : sheet) sum += outward_area(board, body, passed.face);
  return sum;
}

/// Faces at each node of the mesh.
std::map<Index, std::vector<std::size_t>> faces_at_nodes(const SplitBody& body,
                                                         std::span<const PassedFace> faces) {
  std::map<Index, std::vector<std::size_t>> at;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (Index n : body.nodes(faces[f].face)) at[body.in_mesh(n)].push_back(f);
  }
  return at;
}

/// Of each face, the way to it along the sheet in the board's plane [mm].
std::vector<double> ways_from(std::size_t first, const SplitBody& body,
                              std::span<const PassedFace> sheet, const std::vector<Vec2>& places) {
  const auto at_node = faces_at_nodes(body, sheet);
  std::vector<double> way(sheet.size(), std::numeric_limits<double>::infinity());
  using Next = std::pair<double, std::size_t>;
  std::priority_queue<Next, std::vector<Next>, std::greater<>> queue;
  way[first] = 0;
  queue.push({0, first});
  while (!queue.empty()) {
    const auto [here, face] = queue.top();
    queue.pop();
    if (here > way[face]) continue;
    for (Index n : body.nodes(sheet[face].face)) {
      for (std::size_t next : at_node.at(body.in_mesh(n))) {
        const double there = here + (places[next] - places[face]).norm();
        if (!(there < way[next])) continue;
        way[next] = there;
        queue.push({there, next});
      }
    }
  }
  return way;
}

}  // namespace

std::vector<PassedFace> passed_faces(const Problem& problem, const SplitBody& body,
                                     std::span<const std::array<Vec3, 3>> blade,
                                     std::span<const Vec3> places,
                                     std::span<const std::uint8_t> gone) {
  const auto triangles = turned_alike(blade);
  Extent of_blade;
  for (const Triangle& t : triangles) {
    for (const Vec3& p : t) of_blade.add(p);
  }
  const Places at(body, places);
  std::vector<PassedFace> faces;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (gone[static_cast<std::size_t>(e)]) continue;
    for (int f = 0; f < 4; ++f) {
      const Face face{e, f};
      const Index other = body.behind(face);
      if (other < e || body.open(face) || gone[static_cast<std::size_t>(other)]) continue;
      const Vec3 a = at.centroid(e), b = at.centroid(other);
      Extent between;
      between.add(a);
      between.add(b);
      if (!of_blade.meets(between)) continue;
      for (const Triangle& t : triangles) {
        const auto met = meets(t, a, b);
        if (!met) continue;
        const Vec3 place = (1 - met->share) * centroid_in_mesh(problem, e) +
                           met->share * centroid_in_mesh(problem, other);
        faces.push_back({met->a_in_front ? face : body.other_side(face), place});
        break;
      }
    }
  }
  const auto is_passed = [&](Index e) {
    const auto corners = at.corners(e);
    return std::ranges::any_of(triangles,
                               [&](const Triangle& t) { return fem::crosses(t, corners); });
  };
  const auto shut = of_crumbs(body, faces, gone, is_passed);
  std::erase_if(faces, [&](const PassedFace& passed) {
    return shut.contains({passed.face.element, passed.face.opposite});
  });
  return faces;
}

std::vector<std::vector<PassedFace>> sheets(const SplitBody& body,
                                            std::span<const PassedFace> faces) {
  auto at_node = faces_at_nodes(body, faces);
  std::vector<std::uint8_t> seen(faces.size(), 0);
  std::vector<std::vector<PassedFace>> all;
  for (std::size_t first = 0; first < faces.size(); ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> sheet{first};
    seen[first] = 1;
    for (std::size_t i = 0; i < sheet.size(); ++i) {
      for (Index n : body.nodes(faces[sheet[i]].face)) {
        for (std::size_t next : std::exchange(at_node.at(body.in_mesh(n)), {})) {
          if (!std::exchange(seen[next], std::uint8_t{1})) sheet.push_back(next);
        }
      }
    }
    std::sort(sheet.begin(), sheet.end());
    auto& of = all.emplace_back();
    for (std::size_t f : sheet) of.push_back(faces[f]);
  }
  return all;
}

/// Means of the places along the way from one end of the sheet to the other, a board's edge length
/// each; the ends lie as far out as the faces there.
std::vector<Vec2> path_through(const Board& board, const SplitBody& body,
                               std::span<const PassedFace> sheet) {
  std::vector<Vec2> places;
  for (const PassedFace& passed : sheet) places.push_back(board.plane().project(passed.place));
  const auto farthest = [](const std::vector<double>& way) {
    return static_cast<std::size_t>(std::ranges::max_element(way) - way.begin());
  };
  const auto way = ways_from(farthest(ways_from(0, body, sheet, places)), body, sheet, places);
  const double whole = way[farthest(way)];
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::round(whole / board.h())));
  std::vector<std::vector<std::size_t>> piece(pieces);
  for (std::size_t f = 0; f < sheet.size(); ++f) {
    const double share = whole > 0 ? way[f] / whole : 0.0;
    piece[std::min(pieces - 1, static_cast<std::size_t>(share * static_cast<double>(pieces)))]
        .push_back(f);
  }
  std::erase_if(piece, [](const auto& of) { return of.empty(); });
  std::vector<Vec2> path;
  for (const auto& of : piece) {
    Vec2 sum = Vec2::Zero();
    for (std::size_t f : of) sum += places[f];
    path.push_back(sum / static_cast<double>(of.size()));
  }
  const Vec3 area = area_of(board, body, sheet);
  const auto beyond = [&](const std::vector<std::size_t>& of, const Vec2& from, const Vec2& along) {
    double most = 0;
    for (std::size_t f : of) {
      for (const Vec3& x : corners_of(board, body, sheet[f].face)) {
        most = std::max(most, (board.plane().project(x) - from).dot(along));
      }
    }
    return Vec2(from + most * along);
  };
  const auto unit = [&](const Vec2& v) -> Vec2 {
    if (v.norm() > 0) return v.normalized();
    const Vec2 across = board.plane().project(area);  // away from the elements that have the faces
    return across.norm() > 0 ? Vec2(-across.y(), across.x()).normalized() : Vec2(Vec2::UnitX());
  };
  const std::size_t last = path.size() - 1;
  const Vec2 forward = unit(last > 0 ? Vec2(path[last] - path[last - 1]) : Vec2(Vec2::Zero()));
  const Vec2 backward = last > 0 ? unit(path[0] - path[1]) : Vec2(-forward);
  const Vec2 begin = beyond(piece.front(), path[0], backward);
  const Vec2 end = beyond(piece.back(), path[last], forward);
  path.insert(path.begin(), begin);
  path.push_back(end);
  const auto same = [](const Vec2& a, const Vec2& b) { return a == b; };
  path.erase(std::unique(path.begin(), path.end(), same), path.end());
  if (path.size() == 1) path.push_back(path[0] + board.h() * forward);
  int left = 0;
  for (const auto& [face, place] : sheet) {
    left += path_side(path, board.centroid(face.element), 0) -
            path_side(path, board.centroid(body.behind(face)), 0);
  }
  if (left < 0) std::reverse(path.begin(), path.end());
  return path;
}

bool lies_flat(const Board& board, const SplitBody& body, std::span<const PassedFace> sheet) {
  // Of a sheet that bends back on itself the sum is small and says nothing.
  constexpr double kBent = 0.3, kStands = 0.5;
  double sizes = 0;
  for (const PassedFace& passed : sheet) sizes += outward_area(board, body, passed.face).norm();
  const Vec3 area = area_of(board, body, sheet);
  return area.norm() > kBent * sizes && board.plane().project(area).norm() < kStands * area.norm();
}

bool follow_blade(const SplitBody& body, std::span<const PassedFace> faces,
                  std::span<const std::array<Vec3, 3>> blade, std::span<const Vec3> places) {
  constexpr double kAlike = 0.7;  // cosine of 45 deg
  return std::ranges::all_of(faces, [&](const PassedFace& passed) {
    Triangle corners;
    const auto nodes = body.nodes(passed.face);
    for (std::size_t i = 0; i < 3; ++i) corners[i] = places[static_cast<std::size_t>(nodes[i])];
    const Vec3 normal = normal_of(corners).stableNormalized();
    return std::ranges::any_of(blade, [&](const Triangle& t) {
      return std::abs(normal.dot(normal_of(t).stableNormalized())) > kAlike;
    });
  });
}

}  // namespace sunder::fracture
