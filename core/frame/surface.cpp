// SPDX-License-Identifier: Apache-2.0
#include "sunder/surface.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "sunder/error.hpp"

namespace sunder {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

// Corners opposite to each corner, anticlockwise seen from outside in a tetrahedron of positive
// volume.
constexpr std::array<std::array<int, 3>, 4> kOpposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

struct OneSide {
  std::array<Index, 3> nodes;  // ascending
  std::uint32_t slot;
};

/// The element behind each face of the mesh.
std::vector<std::array<Index, 4>> neighbours(const Mesh& mesh) {
  std::vector<OneSide> sides;
  sides.reserve(4 * mesh.tets.size());
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (std::size_t f = 0; f < 4; ++f) {
      std::array<Index, 3> nodes;
      for (std::size_t i = 0; i < 3; ++i) {
        nodes[i] = mesh.tets[e][static_cast<std::size_t>(kOpposite[f][i])];
      }
      std::ranges::sort(nodes);
      sides.push_back({nodes, static_cast<std::uint32_t>(4 * e + f)});
    }
  }
  std::ranges::sort(sides, {}, [](const OneSide& s) { return std::pair(s.nodes, s.slot); });
  std::vector<std::array<Index, 4>> behind(mesh.tets.size(), {kNone, kNone, kNone, kNone});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const std::uint32_t a = sides[i].slot, b = sides[i + 1].slot;
    if (sides[i].nodes != sides[i + 1].nodes) continue;
    behind[a / 4][a % 4] = static_cast<Index>(b / 4);
    behind[b / 4][b % 4] = static_cast<Index>(a / 4);
  }
  return behind;
}

}  // namespace

Surface::Surface(const Simulation& simulation)
    : simulation_(simulation),
      behind_(neighbours(simulation.problem().mesh())),
      gone_(behind_.size(), 1),
      place_(4 * behind_.size(), kNowhere),
      is_changed_(behind_.size(), 0) {
  update();
}

const std::array<Index, 4>& Surface::corners(Index element) const {
  const auto split = simulation_.corners();
  return split.empty() ? simulation_.problem().mesh().tets[element]
                       : split[static_cast<std::size_t>(element)];
}

std::array<Index, 3> Surface::face(Index element, int opposite) const {
  const auto& of = corners(element);
  std::array<Index, 3> nodes;
  for (std::size_t i = 0; i < 3; ++i) {
    nodes[i] = of[static_cast<std::size_t>(kOpposite[static_cast<std::size_t>(opposite)][i])];
  }
  return nodes;
}

/// Whether a live element ends at a face: nothing live shares all nodes of it.
bool Surface::ends(Index element, int opposite) const {
  const Index other =
      behind_[static_cast<std::size_t>(element)][static_cast<std::size_t>(opposite)];
  if (other == kNone || gone_[static_cast<std::size_t>(other)]) return true;
  if (simulation_.corners().empty()) return false;
  const auto& there = corners(other);
  return std::ranges::any_of(face(element, opposite),
                             [&](Index n) { return std::ranges::find(there, n) == there.end(); });
}

std::uint64_t Surface::update() {
  log_.emplace_back();
  find_changes();
  // A face shows for what is on both sides of it.
  for (std::size_t i = 0, own = changed_.size(); i < own; ++i) {
    for (Index other : behind_[static_cast<std::size_t>(changed_[i])]) {
      if (other == kNone || is_changed_[static_cast<std::size_t>(other)]) continue;
      is_changed_[static_cast<std::size_t>(other)] = 1;
      changed_.push_back(other);
    }
  }
  for (Index e : changed_) look_at(e);
  for (Index e : changed_) is_changed_[static_cast<std::size_t>(e)] = 0;
  changed_.clear();
  follow_pieces();
  if (log_.back().empty() && version_ > 0) {
    log_.pop_back();
    return version_;
  }
  if (log_.size() > kVersions) log_.erase(log_.begin());
  return ++version_;
}

/// Elements that are not as the last update saw them.
void Surface::find_changes() {
  const auto gone = simulation_.backend().destroyed();
  const auto split = simulation_.corners();
  const bool same_corners =
      split.size() == corners_.size() &&
      (split.empty() || std::memcmp(split.data(), corners_.data(), split.size_bytes()) == 0);
  const auto add = [&](std::size_t e) {
    is_changed_[e] = 1;
    changed_.push_back(static_cast<Index>(e));
  };
  constexpr std::size_t kBlock = 256;
  for (std::size_t begin = 0; begin < gone.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, gone.size() - begin);
    if (version_ > 0 && std::memcmp(gone.data() + begin, gone_.data() + begin, count) == 0) {
      continue;
    }
    for (std::size_t e = begin; e < begin + count; ++e) {
      if (gone[e] != gone_[e]) add(e);
    }
  }
  if (!same_corners) {
    const auto& mesh = simulation_.problem().mesh().tets;
    for (std::size_t e = 0; e < gone.size(); ++e) {
      const auto& was = corners_.empty() ? mesh[e] : corners_[e];
      const auto& is = split.empty() ? mesh[e] : split[e];
      if (is != was && !is_changed_[e]) add(e);
    }
    corners_.assign(split.begin(), split.end());
  }
  for (Index e : changed_) gone_[static_cast<std::size_t>(e)] = gone[static_cast<std::size_t>(e)];
}

void Surface::look_at(Index element) {
  for (int f = 0; f < 4; ++f) {
    const auto slot = static_cast<std::size_t>(4 * element + f);
    const bool shows = !gone_[static_cast<std::size_t>(element)] && ends(element, f);
    if (shows) {
      set(element, f);
    } else if (place_[slot] != kNowhere) {
      drop(place_[slot]);
    }
  }
}

void Surface::set(Index element, int opposite) {
  const auto e = static_cast<std::size_t>(element), f = static_cast<std::size_t>(opposite);
  const auto slot = static_cast<std::uint32_t>(4 * e + f);
  const SurfaceTriangle triangle{face(element, opposite), element, simulation_.piece_of(element),
                                 behind_[e][f] != kNone};
  std::uint32_t& place = place_[slot];
  if (place == kNowhere) {
    place = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(triangle);
    slots_.push_back(slot);
    touch(place);
    return;
  }
  SurfaceTriangle& there = triangles_[place];
  if (there.nodes == triangle.nodes && there.piece == triangle.piece) return;
  there = triangle;
  touch(place);
}

void Surface::drop(std::uint32_t place) {
  const auto last = static_cast<std::uint32_t>(triangles_.size() - 1);
  place_[slots_[place]] = kNowhere;
  if (place != last) {
    triangles_[place] = triangles_[last];
    slots_[place] = slots_[last];
    place_[slots_[place]] = place;
    touch(place);
  }
  triangles_.pop_back();
  slots_.pop_back();
  touch(last);
}

void Surface::touch(std::uint32_t place) { log_.back().push_back(place); }

/// Pieces are numbered anew whenever they are looked for, which itself costs as much as the body.
void Surface::follow_pieces() {
  if (looks_ == simulation_.looks()) return;
  looks_ = simulation_.looks();
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Index piece = simulation_.piece_of(triangles_[t].element);
    if (triangles_[t].piece == piece) continue;
    triangles_[t].piece = piece;
    touch(static_cast<std::uint32_t>(t));
  }
}

std::vector<std::uint32_t> Surface::changed_since(std::uint64_t version) const {
  std::vector<std::uint32_t> places;
  if (version == 0 || version > version_ || version_ - version > log_.size()) {
    places.resize(triangles_.size());
    for (std::size_t t = 0; t < places.size(); ++t) places[t] = static_cast<std::uint32_t>(t);
    return places;
  }
  for (std::size_t i = log_.size() - (version_ - version); i < log_.size(); ++i) {
    places.insert(places.end(), log_[i].begin(), log_[i].end());
  }
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

std::size_t Surface::node_count() const {
  return static_cast<std::size_t>(simulation_.backend().node_count());
}

void Surface::points(std::span<float> places, std::span<float> normals) const {
  const std::size_t size = 3 * node_count();
  for (const auto& values : {places, normals}) {
    if (!values.empty() && values.size() != size) {
      throw UsageError("a surface has 3 values for each of its " + std::to_string(node_count()) +
                       " nodes");
    }
  }
  const std::vector<Vec3> moved = simulation_.displacement();
  const Mesh mesh = simulation_.mesh();
  std::vector<Vec3> at(moved.size());
  for (std::size_t n = 0; n < at.size(); ++n) at[n] = mesh.nodes[n] + moved[n];
  const auto put = [](std::span<float> to, std::size_t n, const Vec3& v) {
    for (std::size_t i = 0; i < 3; ++i) {
      to[3 * n + i] = static_cast<float>(v[static_cast<Eigen::Index>(i)]);
    }
  };
  for (std::size_t n = 0; n < at.size() && !places.empty(); ++n) put(places, n, at[n]);
  if (normals.empty()) return;
  std::vector<Vec3> sum(at.size(), Vec3::Zero());
  for (const SurfaceTriangle& t : triangles_) {
    const auto [a, b, c] = t.nodes;
    const auto x = [&](Index n) -> const Vec3& { return at[static_cast<std::size_t>(n)]; };
    const Vec3 area = (x(b) - x(a)).cross(x(c) - x(a));
    for (Index n : t.nodes) sum[static_cast<std::size_t>(n)] += area;
  }
  for (std::size_t n = 0; n < sum.size(); ++n) {
    const double length = sum[n].norm();
    put(normals, n, length > 0 ? Vec3(sum[n] / length) : Vec3(Vec3::Zero()));
  }
}

}  // namespace sunder
