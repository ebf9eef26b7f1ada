// SPDX-License-Identifier: Apache-2.0
#include "fracture/field_sif/notch.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "fracture/geometry_factor.hpp"
#include "fracture/stress_intensity.hpp"

namespace sunder::fracture {
namespace {

// Measured on strips with slots and V notches against sharp cracks of the same length
// (tests/core/field_sif/notch_test.cpp).
constexpr double kLongerByWidths = 0.3;
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWidestAngle = 62 * kDegree;  // 60 deg and what a mesh makes of it
// A lozenge of 60 deg is no crack any more: K_I 4 % above, K_II 9 % below.
constexpr double kWidestInternalAngle = 47 * kDegree;

constexpr double kAtTip = 2.0;      // in h: faces this near the tip are the crack's, if any are
constexpr double kWallsWithin = 6;  // in h behind the tip: the walls that tell width and angle

/// A preset's path in the plane; straight.
struct Path {
  Path(const Board& board, const PresetCrack& preset) : internal(!preset.mouth) {
    from = board.plane().project(internal ? preset.tips.front() : *preset.mouth);
    to = board.plane().project(preset.tips.back());
    length = (to - from).norm();
    along = (to - from) / length;
  }
  bool internal;
  Vec2 from, to, along;
  double length = 0;

  [[nodiscard]] double place(const Vec2& p) const { return (p - from).dot(along); }
  [[nodiscard]] double offset(const Vec2& p) const { return (p - from).dot(left_of(along)); }
};

/// A lateral face in the plane.
struct Side {
  std::size_t face;
  Vec2 centre, normal;  // outward, unit
  double area;
};

using Corners = std::array<std::array<double, 3>, 3>;

Corners corners_of(const Mesh& mesh, const FreeSurface::Face& face) {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& x = mesh.nodes[face.nodes[i]];
    corners[i] = {x.x(), x.y(), x.z()};
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Per face: whether another one lies on it.
std::vector<bool> faces_with_twin(const Mesh& mesh, std::span<const FreeSurface::Face> faces) {
  std::map<Corners, int> count;
  for (const FreeSurface::Face& face : faces)
    if (face.lateral) ++count[corners_of(mesh, face)];
  std::vector<bool> twin(faces.size(), false);
  for (std::size_t f = 0; f < faces.size(); ++f)
    twin[f] = faces[f].lateral && count[corners_of(mesh, faces[f])] > 1;
  return twin;
}

Side side_of(const Board& board, const FreeSurface::Face& face, std::size_t index) {
  Vec2 centre = Vec2::Zero();
  for (Index n : face.nodes) centre += board.node(n) / 3;
  const Vec2 normal = board.plane().project(face.area);
  return {index, centre, normal.normalized(), normal.norm()};
}

/// Whether the way out of the body leads from a face to the path: then what lies between is void.
/// A root lies across the path, which it sees behind it.
bool faces_path(const Side& side, const Path& path, double h) {
  const double rounding = 1e-6 * h, behind = 0.01 * h, near = std::min(h, path.length / 2);
  const double place = path.place(side.centre);
  if (!path.internal && place <= rounding) return false;  // at the mouth: the body's outline
  double seen = std::clamp(place, 0.0, path.length);
  if (place > path.length - near) seen = std::min(place, path.length) - behind;
  if (path.internal && place < near) seen = std::max(place, 0.0) + behind;
  return side.normal.dot(path.from + seen * path.along - side.centre) > rounding;
}

/// What is connected by nodes with the candidate nearest to the tip.
std::vector<Side> connected(std::span<const FreeSurface::Face> faces,
                            const std::vector<Side>& candidates, std::size_t first) {
  std::multimap<Index, std::size_t> at_node;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    for (Index n : faces[candidates[c].face].nodes) at_node.emplace(n, c);
  std::set<std::size_t> seen{first};
  std::vector<std::size_t> open{first};
  while (!open.empty()) {
    const std::size_t c = open.back();
    open.pop_back();
    for (Index n : faces[candidates[c].face].nodes) {
      const auto [begin, end] = at_node.equal_range(n);
      for (auto it = begin; it != end; ++it)
        if (seen.insert(it->second).second) open.push_back(it->second);
    }
  }
  std::vector<Side> found;
  for (std::size_t c : seen) found.push_back(candidates[c]);
  return found;
}

/// Opening over the distance behind the tip, as a straight line through the walls.
void measure(std::span<const Side> sides, const Path& path, const Vec2& tip, double h,
             Notch& notch) {
  constexpr double kWall = 0.5;  // |normal . left|; the rest is the root
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Vec2 right = Vec2::Zero();
  double widest = 0;
  for (const Side& side : sides) {
    const double offset = std::abs(path.offset(side.centre));
    const double behind = std::abs(path.place(side.centre) - path.place(tip));
    if (behind > kWallsWithin * h) continue;
    widest = std::max(widest, offset);
    if (std::abs(side.normal.dot(left_of(path.along))) < kWall) continue;
    const Vec2 powers(1, behind);
    normal += side.area * powers * powers.transpose();
    right += side.area * offset * powers;
  }
  const double scale = normal(0, 0) * normal(1, 1);
  if (!(normal.determinant() > 1e-6 * scale)) {  // walls at one distance, or none
    notch.width = 2 * widest;
    return;
  }
  const Vec2 line = normal.inverse() * right;
  notch.width = 2 * std::max(line[0], 0.0);
  notch.angle = 2 * std::atan(std::max(line[1], 0.0));
}

/// The mesh's faces of one preset, if it has any at its tips.
class Search {
 public:
  Search(const Board& board, FreeSurface& surface)
      : board_(board),
        surface_(surface),
        twin_(faces_with_twin(board.mesh(), surface.all())),
        tolerance_(kAtTip * board.h()) {
    for (std::size_t f = 0; f < surface.all().size(); ++f)
      if (surface.all()[f].lateral) sides_.push_back(side_of(board, surface.all()[f], f));
  }

  void look(int crack, const PresetCrack& preset, std::vector<Notch>& notches) {
    const Path path(board_, preset);
    if (!(path.length > 0)) return;
    std::vector<Side> open;
    for (const Side& side : sides_)
      if (!twin_[side.face] && faces_path(side, path, board_.h())) open.push_back(side);
    for (std::size_t tip = 0; tip < preset.tips.size(); ++tip) {
      Notch notch;
      notch.crack = crack;
      notch.tip = static_cast<int>(tip);
      notch.root = path.internal && tip == 0 ? path.from : path.to;
      const std::size_t nearest = nearest_of(open, notch.root);
      const double to_open =
          nearest < open.size() ? distance(open[nearest], notch.root) : tolerance_;
      const double to_closed = distance_of_twins(notch.root);
      if (std::min(to_open, to_closed) >= tolerance_) continue;  // no faces of the mesh end here
      notch.closed = to_closed <= to_open;
      if (!notch.closed) {
        const auto faces = connected(surface_.all(), open, nearest);
        measure(faces, path, notch.root, board_.h(), notch);
        for (const Side& side : faces) surface_.mark(side.face, crack);
      }
      notches.push_back(notch);
    }
  }

 private:
  [[nodiscard]] double distance(const Side& side, const Vec2& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (Index n : surface_.all()[side.face].nodes)
      least = std::min(least, (board_.node(n) - p).norm());
    return least;
  }
  [[nodiscard]] std::size_t nearest_of(const std::vector<Side>& sides, const Vec2& p) const {
    std::size_t nearest = sides.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < sides.size(); ++s) {
      const double d = distance(sides[s], p);
      if (!(d < least)) continue;
      least = d;
      nearest = s;
    }
    return nearest;
  }
  [[nodiscard]] double distance_of_twins(const Vec2& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Side& side : sides_)
      if (twin_[side.face]) least = std::min(least, distance(side, p));
    return least;
  }

  const Board& board_;
  FreeSurface& surface_;
  std::vector<bool> twin_;
  double tolerance_;
  std::vector<Side> sides_;
};

double log_intensity(double a, double b, bool edge) {
  return std::log(edge ? edge_factor(a / b) : internal_factor(2 * a / b)) + std::log(a) / 2;
}

}  // namespace

double blunt_share(double width, double a, double b, bool edge) {
  constexpr double kStep = 0.01;
  if (!(a > 0) || !(b > 0)) return std::numeric_limits<double>::infinity();
  const double slope =
      (log_intensity(a * (1 + kStep), b, edge) - log_intensity(a * (1 - kStep), b, edge)) /
      (2 * kStep * a);
  return kLongerByWidths * width * std::max(slope, 1 / (2 * a));
}

double angle_share(const Notch& notch, double radius, double a, const Vec3& k) {
  // Williams 1952: stress ~ r^(e - 1/2); of 60 deg e = .012 pulled, .231 sheared. The domain sees
  // the field about .75 R from the root, and beyond .6 a the notch is a crack of its depth.
  const double part = notch.angle / (60 * kDegree);
  const double place = std::min(1.0, radius / (0.79 * a));
  const double pulled = 1 - std::pow(place, 0.012 * part * part * part);
  const double sheared = 1 - std::pow(place, 0.231 * part);
  const double size = k.head<2>().norm();
  return size > 0 ? (pulled * std::abs(k[0]) + sheared * std::abs(k[1])) / size : 0;
}

bool sharp_enough(const Notch& notch, double a, double b, bool edge) {
  return notch.angle <= (edge ? kWidestAngle : kWidestInternalAngle) &&
         blunt_share(notch.width, a, b, edge) <= kAccuracy;
}

std::vector<Notch> find_notches(const Problem& problem, const Board& board, FreeSurface& surface) {
  std::vector<Notch> notches;
  const auto& presets = problem.scene().cracks;
  const auto& elements = problem.crack_elements();
  if (std::ranges::none_of(elements, [](const auto& list) { return list.empty(); })) return notches;
  Search search(board, surface);
  for (std::size_t c = 0; c < presets.size(); ++c)
    if (elements[c].empty()) search.look(static_cast<int>(c), presets[c], notches);
  return notches;
}

}  // namespace sunder::fracture
