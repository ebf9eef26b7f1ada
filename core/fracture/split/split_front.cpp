// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/split_front.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"

namespace sunder::fracture {
namespace {

constexpr double kBand = 2.5;       // of a piece of the path, in h: what may change sides
constexpr int kPieces = 6;          // of the path in one step
constexpr std::size_t kSmall = 12;  // elements: a group that must not come loose
constexpr int kTurns = 12;          // of small groups; then their faces stay shut
// Of the path's end, in h: faces that make the front; where there are none, what a sharp kink has
// left behind.
constexpr double kNear = 2.5, kLeftBehind = 5;
constexpr double kBeyond = 0.3;   // of h: nodes of a face this far beyond the path's end are at it
constexpr double kMoved = 0.05;   // of h: less is no progress
constexpr double kOnPath = 1e-6;  // of h: a centroid no farther from the path lies on it

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double size = along.squaredNorm();
  const double share = size > 0 ? std::clamp((p - a).dot(along) / size, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

}  // namespace

/// One attempt to open faces along a path.
struct SplitFront::Work {
  const Crack& crack;
  SplitCrack& split;
  std::span<const std::uint8_t> destroyed;
  const Parts& parts;
  Vec2 from, to;             // the newest piece of the path
  Vec2 ahead;                // unit: faces beyond `to` in this direction stay shut
  bool both_ends = false;    // likewise beyond `from`, backwards
  std::vector<Index> seeds;  // nodes from which faces hang together; empty: all count
  fem::Change& change;

  std::map<Index, int> label = {};            // of the band
  std::set<Index> turned = {};                // from the side of the path on which they lie
  std::vector<Face> faces = {};               // to open, of the elements left of the path
  std::set<std::pair<Index, int>> kept = {};  // that stay shut, as the left element has them
  bool held = false;                          // some that would have to open do not part
  bool spent = false;                         // more nodes would come than are allowed
  double area = 0;
  std::vector<Index> front = {};  // nodes of faces at which elements still hang together
};

SplitFront::SplitFront(const Board& board, const Problem& problem, SplitBody& body)
    : board_(board), problem_(problem), body_(body) {}

Vec2 SplitFront::middle(std::span<const Index> nodes) const {
  Vec2 sum = Vec2::Zero();
  for (Index n : nodes) sum += board_.node(body_.in_mesh(n));
  return sum / static_cast<double>(nodes.size());
}

bool SplitFront::outside(const Vec2& p) const { return !(board_.plane().inside(p) > 0); }

double SplitFront::area_of(const Face& face) const {
  const auto [a, b, c] = body_.nodes(face);
  const auto at = [this](Index n) -> const Vec3& {
    return problem_.mesh().nodes[static_cast<std::size_t>(body_.in_mesh(n))];
  };
  return (at(b) - at(a)).cross(at(c) - at(a)).norm() / 2;
}

std::vector<Index> SplitFront::nodes_at(const Vec2& tip) const {
  constexpr double kSame = 0.25;  // of h
  double nearest = std::numeric_limits<double>::infinity();
  for (Index n = 0; n < problem_.node_count(); ++n) {
    if (!body_.elements_of(n).empty()) nearest = std::min(nearest, (board_.node(n) - tip).norm());
  }
  std::vector<Index> nodes;
  for (Index n = 0; n < problem_.node_count(); ++n) {
    if (body_.elements_of(n).empty()) continue;
    if ((board_.node(n) - tip).norm() <= nearest + kSame * board_.h()) nodes.push_back(n);
  }
  return nodes;
}

/// +1 left of a path, -1 right of it. Whose centroid lies on it belongs to the side on which the
/// board's middle lies, or, where the path points at that too, to the upper one: cracks that mirror
/// each other take mirrored sides.
int SplitFront::side_of(const Crack& crack, Index element) const {
  const double on_path = kOnPath * board_.h();
  const int side = path_side(crack, board_.centroid(element), on_path);
  if (side != 0) return side;
  const BoardPlane& plane = board_.plane();
  const int middle = path_side(crack, (plane.outline_min + plane.outline_max) / 2, on_path);
  return middle != 0 ? middle : upper_side(crack);
}

void SplitFront::label_band(Work& work) const {
  std::vector<Index> near;
  board_.elements_within((work.from + work.to) / 2,
                         kBand * board_.h() + (work.to - work.from).norm() / 2, near);
  work.label.clear();
  for (Index e : near) {
    if (work.destroyed[static_cast<std::size_t>(e)]) continue;
    if (distance(board_.centroid(e), work.from, work.to) > kBand * board_.h()) continue;
    const auto before = work.split.label.find(e);
    int side = before != work.split.label.end() ? before->second : side_of(work.crack, e);
    if (work.turned.contains(e)) side = -side;
    work.label[e] = side;
  }
}

/// Whether a face lies up to the path's end with all of its nodes: fronts are then as straight as
/// the mesh lets them be. One that is ragged opens no further than its hindmost nodes.
bool SplitFront::within(const Face& face, const Work& work) const {
  const double beyond = kBeyond * board_.h();
  return std::ranges::all_of(body_.nodes(face), [&](Index n) {
    const Vec2 at = board_.node(body_.in_mesh(n));
    if ((at - work.to).dot(work.ahead) > beyond) return false;
    return !work.both_ends || (at - work.from).dot(work.ahead) > -beyond;
  });
}

/// Faces between the two sides that are not open yet, up to the path's end.
void SplitFront::find_faces(Work& work) const {
  work.faces.clear();
  work.held = false;
  for (const auto& [e, side] : work.label) {
    if (side < 0) continue;
    for (int i = 0; i < 4; ++i) {
      const Face face{e, i};
      const Index other = body_.behind(face);
      if (other == kNone || body_.open(face) || work.kept.contains({e, i})) continue;
      const auto right = work.label.find(other);
      if (right == work.label.end() || right->second > 0) continue;
      if (!within(face, work)) continue;
      if (!work.parts(e, other)) {
        work.held = true;
        continue;
      }
      work.faces.push_back(face);
    }
  }
}

/// Of them those that hang together with the front by shared nodes: so it stops at other cracks.
void SplitFront::join(Work& work) const {
  if (work.seeds.empty()) return;
  std::map<Index, std::vector<std::size_t>> at_node;
  for (std::size_t f = 0; f < work.faces.size(); ++f) {
    for (Index n : body_.nodes(work.faces[f])) at_node[n].push_back(f);
  }
  std::vector<std::uint8_t> joined(work.faces.size(), 0);
  std::vector<Index> nodes = work.seeds;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto found = at_node.find(nodes[i]);
    if (found == at_node.end()) continue;
    for (std::size_t f : found->second) {
      if (joined[f]) continue;
      joined[f] = 1;
      for (Index n : body_.nodes(work.faces[f])) nodes.push_back(n);
    }
    at_node.erase(found);
  }
  std::vector<Face> kept;
  for (std::size_t f = 0; f < work.faces.size(); ++f) {
    if (joined[f]) kept.push_back(work.faces[f]);
  }
  work.faces.swap(kept);
}

/// Small groups of the band that would hang on nothing change sides, or, `keep`, keep their faces
/// shut. False: there are none.
bool SplitFront::turn_small_groups(Work& work, bool keep) const {
  std::set<std::pair<Index, int>> opening;
  for (const Face& face : work.faces) {
    opening.insert({face.element, face.opposite});
    const Face other = body_.other_side(face);
    opening.insert({other.element, other.opposite});
  }
  std::set<Index> seen;
  bool any = false;
  for (const auto& [first, side] : work.label) {
    if (seen.contains(first)) continue;
    // As far as it takes to see that it is no small one, beyond the band too.
    std::vector<Index> group{first};
    std::set<Index> in_group{first};
    for (std::size_t i = 0; i < group.size() && group.size() < kSmall; ++i) {
      for (int f = 0; f < 4; ++f) {
        const Face face{group[i], f};
        const Index next = body_.behind(face);
        if (next == kNone || body_.open(face) || opening.contains({group[i], f}) ||
            work.destroyed[static_cast<std::size_t>(next)]) {
          continue;
        }
        if (in_group.insert(next).second) group.push_back(next);
      }
    }
    seen.insert(group.begin(), group.end());
    if (group.size() >= kSmall) continue;
    const auto opens = [&](Index e) {
      for (int f = 0; f < 4; ++f) {
        if (opening.contains({e, f})) return true;
      }
      return false;
    };
    if (std::ranges::none_of(group, opens)) continue;  // loose already
    any = true;
    for (Index e : group) {
      if (!keep) {
        if (work.label.contains(e) && !work.turned.insert(e).second) work.turned.erase(e);
        continue;
      }
      for (const Face& face : work.faces) {
        if (face.element == e || body_.behind(face) == e) {
          work.kept.insert({face.element, face.opposite});
        }
      }
    }
  }
  return any;
}

/// Opens what the path asks for; false: nothing.
bool SplitFront::open_along(Work& work) {
  for (int turn = 0;; ++turn) {
    label_band(work);
    find_faces(work);
    join(work);
    if (!turn_small_groups(work, turn >= kTurns) || turn == 2 * kTurns) break;
  }
  if (work.faces.empty()) return false;
  if (!body_.open(work.faces, work.destroyed, work.change)) {
    work.spent = true;
    return false;
  }
  for (const Face& face : work.faces) {
    work.area += area_of(face);
    work.split.faces.push_back(face);
    for (Index e : {face.element, body_.behind(face)}) {
      work.split.label[e] = static_cast<std::int8_t>(work.label.at(e));
    }
  }
  return true;
}

/// Where faces that gape end, near a tip's end of the path. A face whose nodes are all whole still
/// holds: it shows no opening.
std::vector<Index> SplitFront::front_of(const Crack& crack, const SplitCrack& split,
                                        std::size_t tip,
                                        std::span<const std::uint8_t> destroyed) const {
  const auto front = front_within(kNear * board_.h(), crack, split, tip, destroyed);
  return front.empty() ? front_within(kLeftBehind * board_.h(), crack, split, tip, destroyed)
                       : front;
}

std::vector<Index> SplitFront::front_within(double radius, const Crack& crack,
                                            const SplitCrack& split, std::size_t tip,
                                            std::span<const std::uint8_t> destroyed) const {
  const bool at_front = orientation(crack, tip) < 0;
  const Vec2 end = at_front ? crack.path.front() : crack.path.back();
  const Vec2 other = at_front ? crack.path.back() : crack.path.front();
  std::set<Index> nodes;
  for (const Face& face : split.faces) {
    const auto left = body_.nodes(face);
    const Vec2 at = middle(left);
    if ((at - end).norm() > radius) continue;
    if (crack.kind == CrackKind::internal && (at - end).norm() > (at - other).norm()) continue;
    const auto right = body_.nodes(body_.other_side(face));
    const auto shared = [&](Index n) { return std::ranges::find(right, n) != right.end(); };
    if (std::ranges::all_of(left, shared)) continue;
    for (Index n : left) {
      if (shared(n) && body_.whole(n, destroyed)) nodes.insert(n);
    }
  }
  return {nodes.begin(), nodes.end()};
}

SplitStep SplitFront::advance(Crack& crack, SplitCrack& split, std::size_t tip,
                              const Vec2& direction, double length,
                              std::span<const std::uint8_t> destroyed, const Parts& parts) {
  SplitStep step;
  const auto path = crack.path;
  const double length_before = crack.length;
  CrackTip& at = crack.tips[tip];
  const CrackTip before = at;
  const bool at_front = orientation(crack, tip) < 0;
  std::vector<Index>& front = split.front[tip];
  for (int piece = 0; piece < kPieces; ++piece) {
    const auto path_here = crack.path;
    const double length_here = crack.length;
    at.position = at_front ? crack.path.front() : crack.path.back();
    const Vec2 from = at.position;
    advance_tip(crack, tip, direction, length);
    Work work{crack,       split,     destroyed, parts, from,
              at.position, direction, false,     front, step.change};
    const bool opened = open_along(work);
    step.held = work.held;
    step.area += work.area;
    if (work.spent) {
      step.spent = true;
      crack.path = path_here;
      crack.length = length_here;
      break;
    }
    if (!opened) {
      if (step.moved() && outside(at.position)) break;
      continue;
    }
    const std::vector<Index> now = front_of(crack, split, tip, destroyed);
    if (now.empty() && !step.moved()) continue;  // faces whose nodes still hold
    front = now;
    step.through = front.empty() || outside(at.position);
    if (step.through) break;
    step.advance = (middle(front) - before.position).dot(direction);
    if (step.advance > kMoved * board_.h()) break;
  }
  split.area += step.area;
  if (!step.moved()) {
    crack.path = path;
    crack.length = length_before;
    at = before;
    step.through = !step.held && !step.spent;
    return step;
  }
  split.grown = true;
  if (step.through) {
    step.advance = (at.position - before.position).dot(direction);
  } else {
    at.position = middle(front);
  }
  return step;
}

/// Whether nodes have parted on both surfaces of the board.
bool SplitFront::through_thickness(const fem::Change& change) const {
  const auto any = [&](auto&& on) {
    return std::ranges::any_of(change.nodes, [&](const fem::NewNode& n) { return on(n.parent); });
  };
  return any([&](Index n) { return board_.on_bottom(n); }) &&
         any([&](Index n) { return board_.on_top(n); });
}

SplitStep SplitFront::bear(Crack& crack, SplitCrack& split, Index element,
                           std::span<const std::uint8_t> destroyed, const Parts& parts) {
  SplitStep step;
  const Vec2 along = (crack.path.back() - crack.path.front()).normalized();
  const bool edge = crack.kind == CrackKind::edge;
  for (int longer = 0; longer < kPieces && !through_thickness(step.change); ++longer) {
    if (longer > 0) {
      crack.path.back() += board_.h() / 2 * along;
      if (!edge) crack.path.front() -= board_.h() / 2 * along;
    }
    Work work{crack, split, destroyed, parts,      crack.path.front(), crack.path.back(),
              along, !edge, {},        step.change};
    work.seeds.assign(body_.corners(element).begin(), body_.corners(element).end());
    for (const Face& face : split.faces) {
      for (Index n : body_.nodes(face)) work.seeds.push_back(n);
    }
    static_cast<void>(open_along(work));
    step.area += work.area;
    step.held = work.held;
    step.spent = work.spent;
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      split.front[tip] = front_of(crack, split, tip, destroyed);
    }
  }
  crack.length = (crack.path.back() - crack.path.front()).norm();
  split.grown = step.moved();
  split.area += step.area;
  for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
    CrackTip& at = crack.tips[tip];
    const auto& front = split.front[tip];
    at.position = front.empty()
                      ? (orientation(crack, tip) < 0 ? crack.path.front() : crack.path.back())
                      : middle(front);
    at.ended = front.empty() && step.moved();
  }
  return step;
}

}  // namespace sunder::fracture
