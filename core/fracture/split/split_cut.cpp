// SPDX-License-Identifier: Apache-2.0
// Cracks that a blade makes (method.md "Split cracks"): the faces that it has passed open at once,
// and where they end inside the body later frames go on.
#include <algorithm>
#include <string>

#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"
#include "fracture/split/blade.hpp"
#include "fracture/split/split_cracks.hpp"
#include "sunder/error.hpp"

namespace sunder::fracture {
namespace {

// Beside cuts that were made before a face or two may be all that is left to open: how so few lie
// says nothing of how the blade stood.
constexpr std::size_t kManyFaces = 6;

[[noreturn]] void refuse_flat_blade() {
  throw UsageError(
      "the blade lies along the board's plane, and split cracks stand on it; turn the blade, or "
      "take fracture.crack = \"destroyed\"");
}

void turn_round(Crack& crack, SplitCrack& split, const SplitBody& body) {
  std::reverse(crack.path.begin(), crack.path.end());
  for (auto& [element, side] : split.label) side = static_cast<std::int8_t>(-side);
  for (Face& face : split.faces) face = body.other_side(face);
}

}  // namespace

void SplitFront::take_cut(Crack& crack, SplitCrack& split, std::span<const PassedFace> sheet,
                          std::span<const std::uint8_t> destroyed) const {
  for (const auto& [face, place] : sheet) {
    split.faces.push_back(face);
    split.area += area_of(face);
    split.label[face.element] = 1;
    split.label[body_.behind(face)] = -1;
  }
  split.grown = true;
  for (std::size_t k = 1; k < crack.path.size(); ++k) {
    crack.length += (crack.path[k] - crack.path[k - 1]).norm();
  }
  // Both ends of its path are tips until it is known where it comes out.
  crack.kind = CrackKind::internal;
  const auto ends = [&](std::size_t tip) {
    const Vec2& end = tip == 0 ? crack.path.front() : crack.path.back();
    if (at_outline(board_, end)) return std::vector<Index>{};
    return front_of(crack, split, tip, destroyed);
  };
  std::array<std::vector<Index>, 2> fronts{ends(0), ends(1)};
  if (fronts[0].empty() || fronts[1].empty()) {
    crack.kind = CrackKind::edge;
    if (fronts[1].empty() && !fronts[0].empty()) {
      turn_round(crack, split, body_);
      std::swap(fronts[0], fronts[1]);
    }
    crack.mouth = crack.path.front();
    fronts = {std::move(fronts[1]), {}};
  }
  crack.tips.resize(crack.kind == CrackKind::edge ? 1 : 2);
  for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
    const bool at_front = orientation(crack, tip) < 0;
    const std::size_t last = crack.path.size() - 1;
    const Vec2& end = crack.path[at_front ? 0 : last];
    const Vec2& before = crack.path[at_front ? 1 : last - 1];
    split.front[tip] = std::move(fronts[tip]);
    const auto& front = split.front[tip];
    crack.tips[tip] = {front.empty() ? end : middle(front), (end - before).normalized(),
                       front.empty()};
  }
}

std::vector<PassedFace> SplitCracks::passed(std::span<const std::array<Vec3, 3>> blade,
                                            std::span<const Vec3> places,
                                            std::span<const std::uint8_t> gone) const {
  auto faces = passed_faces(problem_, body_, blade, places, gone);
  if (faces.size() < kManyFaces && lies_flat(board_, body_, faces) &&
      follow_blade(body_, faces, blade, places)) {
    refuse_flat_blade();
  }
  return faces;
}

void SplitCracks::check_opening(std::span<const PassedFace> faces,
                                std::span<const std::uint8_t> gone) {
  const auto refuse = [](const Face& face, const std::string& why) {
    throw UsageError("face " + std::to_string(face.opposite) + " of element " +
                     std::to_string(face.element) + " cannot be opened: " + why);
  };
  std::vector<std::pair<Index, int>> named;
  for (const auto& [face, place] : faces) {
    if (face.element < 0 || face.element >= problem_.tet_count() || face.opposite < 0 ||
        face.opposite > 3) {
      refuse(face, "the mesh has none of that number");
    }
    const Index other = body_.behind(face);
    if (other == kNone) refuse(face, "no element lies behind it");
    if (body_.open(face)) refuse(face, "it is open already");
    if (gone[static_cast<std::size_t>(face.element)] || gone[static_cast<std::size_t>(other)]) {
      refuse(face, "an element beside it is gone");
    }
    if (!place.allFinite()) refuse(face, "the place where the blade passed must be finite");
    const Face as_other = body_.other_side(face);
    named.emplace_back(face.element, face.opposite);
    named.emplace_back(as_other.element, as_other.opposite);
  }
  std::sort(named.begin(), named.end());
  const auto twice = std::adjacent_find(named.begin(), named.end());
  if (twice != named.end()) refuse({twice->first, twice->second}, "it is named twice");
  // All of them together: a few jagged faces by themselves may lie in any way.
  if (faces.size() >= kManyFaces && lies_flat(board_, body_, faces)) refuse_flat_blade();
  std::vector<Face> all;
  for (const PassedFace& passed : faces) all.push_back(passed.face);
  if (!body_.can_open(all, gone)) {
    throw UsageError("the cut would bring more nodes than the " +
                     std::to_string(most_nodes_ - problem_.node_count()) +
                     " that splitting may add; set fracture.max_new_nodes higher, or cut less");
  }
}

void SplitCracks::open(std::span<const PassedFace> faces, const FractureState& state,
                       Decision& decision) {
  kept_.reset();
  const auto all_sheets = sheets(body_, faces);
  std::vector<std::vector<Vec2>> paths;
  for (const auto& sheet : all_sheets) paths.push_back(path_through(board_, body_, sheet));
  std::vector<Face> all;
  for (const PassedFace& passed : faces) all.push_back(passed.face);
  SplitStep step;
  if (!body_.open(all, state.destroyed, step.change)) throw UsageError("too many nodes would come");
  follow(step, decision);
  end_passed_tips(step.change);
  for (std::size_t s = 0; s < all_sheets.size(); ++s) {
    Crack crack;
    crack.id = static_cast<int>(cracks_.size());
    crack.path.assign(paths[s].begin(), paths[s].end());
    SplitCrack split;
    front_.take_cut(crack, split, all_sheets[s], state.destroyed);
    DestroyedElement row;
    row.lives = true;
    row.cause = Cause::script;
    row.crack = crack.id;
    decision.elements.push_back(row);
    exclude(split, decision);
    cracks_.push_back(std::move(crack));
    splits_.push_back(std::move(split));
  }
  if (!problem_.finite() && !problem_.moves()) tie_what_is_loose(state, decision);
  decision.change.held = true;
  std::sort(decision.excluded.begin(), decision.excluded.end());
}

/// Where the blade has parted most of a tip's front, what it has opened goes on in its place.
void SplitCracks::end_passed_tips(const fem::Change& change) {
  std::vector<Index> parted;
  for (const fem::NewNode& n : change.nodes) parted.push_back(n.parent);
  std::sort(parted.begin(), parted.end());
  for (Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      const auto& front = splits_[static_cast<std::size_t>(crack.id)].front[tip];
      const auto count = std::ranges::count_if(front, [&](Index n) {
        return std::binary_search(parted.begin(), parted.end(), body_.in_mesh(n));
      });
      if (2 * static_cast<std::size_t>(count) > front.size()) crack.tips[tip].ended = true;
    }
  }
}

}  // namespace sunder::fracture
