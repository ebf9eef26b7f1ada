// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/split_cracks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"
#include "fracture/in_plane_stress.hpp"
#include "fracture/preset_cracks.hpp"
#include "fracture/pressed_nodes.hpp"
#include "fracture/split/crack_tip_offset.hpp"
#include "fracture/stress_intensity.hpp"
#include "fracture/worst_element.hpp"

namespace sunder::fracture {
namespace {

constexpr Index kFewestNewNodes = 1000;

Index most_nodes(const Problem& problem) {
  const int asked = problem.scene().fracture.max_new_nodes;
  const Index most = asked > 0 ? asked : std::max(problem.node_count(), kFewestNewNodes);
  return problem.node_count() + most;
}

/// Length of a crack up to the front at a tip, which its path may have passed.
double length_to(const Crack& crack, std::size_t tip) {
  const Vec2& end = orientation(crack, tip) < 0 ? crack.path.front() : crack.path.back();
  return crack.length - (end - crack.tips[tip].position).dot(crack.tips[tip].direction);
}

}  // namespace

SplitCracks::SplitCracks(const Problem& problem)
    : problem_(problem),
      board_(problem.mesh(), problem.scene().fracture.plane_normal),
      meter_(problem, board_),
      toughness_(problem, board_),
      body_(problem),
      front_(board_, problem, body_),
      lips_(problem, board_),
      loose_(problem),
      most_nodes_(most_nodes(problem)),
      excluded_(problem.mesh().tets.size(), 0) {
  body_.allow(most_nodes_);
}

std::shared_ptr<const CriterionState> SplitCracks::state() const {
  if (!kept_) {
    kept_ = std::make_shared<const Kept>(Kept{cracks_, splits_, excluded_, body_.state()});
  }
  auto state = std::make_shared<State>();
  state->kept = kept_;
  state->lips = lips_.state();
  return state;
}

void SplitCracks::restore(const CriterionState& of) {
  const auto& state = dynamic_cast<const State&>(of);
  cracks_ = state.kept->cracks;
  splits_ = state.kept->splits;
  excluded_ = state.kept->excluded;
  body_.restore(state.kept->body);
  lips_.restore(state.lips);
  kept_ = state.kept;
}

/// Preset cracks of destroyed elements, or of the mesh's own faces, go on as splits from their
/// tips.
Decision SplitCracks::preset() {
  kept_.reset();
  const auto& presets = problem_.scene().cracks;
  for (std::size_t c = 0; c < presets.size(); ++c) {
    cracks_.push_back(
        preset_crack(board_, presets[c], static_cast<int>(c), problem_.crack_elements()[c]));
    SplitCrack& split = splits_.emplace_back();
    for (std::size_t tip = 0; tip < cracks_.back().tips.size(); ++tip) {
      split.front[tip] = front_.nodes_at(cracks_.back().tips[tip].position);
    }
  }
  Decision decision;
  decision.elements = preset_elements(problem_);
  for (const DestroyedElement& row : decision.elements) {
    for (Index n : problem_.mesh().tets[row.element]) {
      for (Index e : board_.elements_of(n)) {
        if (excluded_[e]) continue;
        excluded_[e] = 1;
        decision.excluded.push_back(e);
      }
    }
  }
  std::sort(decision.excluded.begin(), decision.excluded.end());
  return decision;
}

FieldView SplitCracks::view(const FractureState& state) const {
  FieldView view{state.destroyed, state.displacement,
                 state.forces ? state.forces() : std::span<const NodalForce>{}};
  view.corners = body_.corners();
  view.pools = state.pools;
  return view;
}

/// A crack that is still as it was preset has no lips of its own yet.
FieldView::Lips SplitCracks::lips_at(const Crack& crack, std::size_t tip) const {
  constexpr double kBehind = 2;  // in h
  if (!splits_[static_cast<std::size_t>(crack.id)].grown) return FieldView::Lips::unknown;
  const Vec2& place = crack.tips[tip].position;
  return lips_.pressed_near(crack.id, place, kBehind * board_.h()) ? FieldView::Lips::pressed
                                                                   : FieldView::Lips::free;
}

/// Where a tip is for the field: linear tetrahedra hold a split crack too stiffly at its end.
Crack SplitCracks::measured(const Crack& crack, std::size_t tip) const {
  const SplitCrack& split = splits_[static_cast<std::size_t>(crack.id)];
  if (!split.grown) return crack;  // still as it was preset
  return as_its_field_shows(crack, tip, board_, problem_.material(split.faces.back().element));
}

void SplitCracks::tips(const FractureState& state, std::vector<TipState>& tips,
                       std::vector<Finding>& findings) {
  FieldView field = view(state);
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      tips.push_back(tip_state(board_, crack, tip));
      if (crack.tips[tip].ended) continue;
      add_field_state(meter_, measured(crack, tip), tip, at_tip(field, crack, tip), tips.back(),
                      findings);
      add_toughness(crack, tip, field, tips.back());
    }
  }
}

void SplitCracks::add_toughness(const Crack& crack, std::size_t tip, const FieldView& field,
                                TipState& state) {
  if (!toughness_.any()) return;
  const double theta = state.theta.value_or(0.0) * std::numbers::pi / 180;
  const Vec2 direction = turned(crack.tips[tip].direction, theta);
  const double k_c = toughness_.view(young_at(crack, tip, field), direction)
                         .of(ahead(crack, tip, direction, field.destroyed));
  if (!(k_c > 0)) return;
  state.toughness = k_c;
  const TipMaterial material = meter_.material_at(measured(crack, tip), tip, field);
  state.toughness_state = material.constraint > 0 ? "plane strain" : "plane stress";
}

void SplitCracks::decide(const FractureState& state, Decision& decision) {
  decision.clear();
  driven_.clear();
  ran_through_ = false;
  FieldView field = view(state);
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      if (crack.tips[tip].ended) continue;
      const auto growth = field_growth(meter_, measured(crack, tip), tip, at_tip(field, crack, tip),
                                       decision.findings);
      if (growth) driven_.push_back({crack.id, *growth});
    }
  }
  for (const Driven& driven : driven_) grow(driven, state, decision);
  if (decision.change.come.empty()) bear(state, decision);
  // At finite deformation what is loose is frozen, in motion it moves on.
  const bool ties = !problem_.finite() && !problem_.moves();
  if (ran_through_ && ties) tie_what_is_loose(state, decision);
  decision.change.held = true;
  std::sort(decision.excluded.begin(), decision.excluded.end());
}

/// A piece that nothing holds any more stays where it is by as much as destroyed elements would
/// hold it: a share alpha of a cube of tissue at each node.
void SplitCracks::tie_what_is_loose(const FractureState& state, Decision& decision) {
  loose_.look(state.destroyed, body_.corners(), body_.node_count());
  if (loose_.pieces() == 0) return;
  const double alpha = problem_.scene().fracture.alpha;
  for (Index n = problem_.node_count(); n < body_.node_count(); ++n) {
    const Index own = body_.live_at(n, state.destroyed);
    const Index other = body_.live_at(body_.in_mesh(n), state.destroyed);
    if (own == kNone || other == kNone || loose_.piece_of(own) == loose_.piece_of(other)) continue;
    const double size = std::cbrt(problem_.shape(own).volume);
    decision.change.ties.push_back({n, alpha * problem_.small_strain(own).young * size});
    lips_.loosen(n);
  }
}

bool SplitCracks::full() const { return body_.node_count() >= most_nodes_; }

/// A piece of the path is h long. As where elements are destroyed (method.md 10), none is reached
/// by less than half an edge length.
void SplitCracks::grow(const Driven& driven, const FractureState& state, Decision& decision) {
  if (full()) {
    decision.findings.push_back({Finding::Kind::nodes_spent});
    return;
  }
  kept_.reset();
  const TipGrowth& growth = driven.growth;
  const auto tip = static_cast<std::size_t>(growth.terms.tip);
  Crack& crack = cracks_[static_cast<std::size_t>(driven.crack)];
  SplitCrack& split = splits_[static_cast<std::size_t>(driven.crack)];
  const double k = growth.terms.k, length = board_.h();
  const ToughnessView toughness =
      toughness_.view(young_at(crack, tip, view(state)), growth.direction);
  const auto lets_pass = [&](Index e) {
    if (const double k_c = toughness.of(e); k_c > 0) return k >= k_c;
    const double yield = problem_.yield(e);
    return yield > 0 && reach(k, yield, growth.theta) >= length / 2;
  };
  const auto parts = [&](Index a, Index b) { return lets_pass(a) || lets_pass(b); };
  const Index next = ahead(crack, tip, growth.direction, state.destroyed);
  const CrackTip before = crack.tips[tip];
  const double measured_at = length_to(crack, tip);
  const SplitStep step =
      front_.advance(crack, split, tip, growth.direction, length, state.destroyed, parts);
  crack.tips[tip].ended = step.through;
  if (step.spent) decision.findings.push_back({Finding::Kind::nodes_spent});
  if (!step.moved()) return;
  ran_through_ = ran_through_ || step.through;
  follow(step, decision);
  DestroyedElement row;
  row.lives = true;
  row.cause = Cause::sif;
  row.crack = crack.id;
  row.sif = growth.terms;
  row.sif->advance = step.advance;
  if (const double k_c = toughness.of(next); k_c > 0) {
    row.sif->toughness = k_c;
    row.ratio = k / k_c;
  } else if (problem_.breakable(next)) {
    row.sif->reach = reach(k, problem_.yield(next), growth.theta);
    row.ratio = row.sif->reach / (length / 2);
  }
  row.sif->a = measured_at;
  row.sif->at = before.position;
  row.sif->d = before.direction;
  decision.elements.push_back(row);
  exclude(split, decision);
}

double SplitCracks::young_at(const Crack& crack, std::size_t tip, const FieldView& field) {
  if (!toughness_.by_energy()) return 0;
  return meter_.material_at(measured(crack, tip), tip, field).effective_young();
}

const FieldView& SplitCracks::at_tip(FieldView& field, const Crack& crack, std::size_t tip) {
  field.lips = lips_at(crack, tip);
  if (toughness_.by_direction()) {
    field.resistance =
        toughness_.around(crack.tips[tip].position, young_at(crack, tip, field), field.destroyed);
  }
  return field;
}

/// The live element half an edge length ahead of a tip.
Index SplitCracks::ahead(const Crack& crack, std::size_t tip, const Vec2& direction,
                         std::span<const std::uint8_t> destroyed) const {
  const Vec2 at = crack.tips[tip].position + board_.h() / 2 * direction;
  std::vector<Index> near;
  board_.elements_within(at, 2 * board_.h(), near);
  std::erase_if(near, [&](Index e) { return destroyed[e] != 0; });
  const auto nearer = [&](Index a, Index b) {
    return (board_.centroid(a) - at).squaredNorm() < (board_.centroid(b) - at).squaredNorm();
  };
  const auto nearest = std::ranges::min_element(near, nearer);
  return nearest == near.end() ? 0 : *nearest;
}

void SplitCracks::bear(const FractureState& state, Decision& decision) {
  auto row = rupture(state.summary.candidate, Cause::mss);
  if (!row || full()) return;
  kept_.reset();
  const InPlane stress = in_plane(state.current_stress(row->element), board_.plane());
  const int id = static_cast<int>(cracks_.size());
  Crack crack = born_crack(board_, row->element, stress, id, std::pmr::get_default_resource());
  crack.elements.clear();
  SplitCrack split;
  const auto parts = [&](Index a, Index b) {
    return problem_.destructible(a) || problem_.destructible(b);
  };
  const SplitStep step = front_.bear(crack, split, row->element, state.destroyed, parts);
  if (step.spent) decision.findings.push_back({Finding::Kind::nodes_spent});
  if (!step.moved() && step.spent) return;
  if (!step.moved()) {  // too little room for a surface: no other try
    excluded_[row->element] = 1;
    decision.excluded.push_back(row->element);
    return;
  }
  ran_through_ = ran_through_ || std::ranges::any_of(crack.tips, &CrackTip::ended);
  cracks_.push_back(std::move(crack));
  splits_.push_back(std::move(split));
  follow(step, decision);
  row->crack = id;
  row->lives = true;
  decision.elements.push_back(*row);
  exclude(splits_.back(), decision);
}

/// Elements of several tips may be the same: the last step has their corners.
void SplitCracks::follow(const SplitStep& step, Decision& decision) const {
  fem::Change& all = decision.change;
  all.nodes.insert(all.nodes.end(), step.change.nodes.begin(), step.change.nodes.end());
  for (const fem::Coming& c : step.change.come) {
    const auto before = std::ranges::find(all.come, c.element, &fem::Coming::element);
    if (before == all.come.end()) {
      all.come.push_back(c);
    } else {
      before->form = c.form;
    }
  }
}

/// What touches a crack starts no other: its tips are judged by K.
void SplitCracks::exclude(const SplitCrack& split, Decision& decision) {
  for (const Face& face : split.faces) {
    for (Index n : body_.nodes(face)) {
      for (Index e : board_.elements_of(body_.in_mesh(n))) {
        if (excluded_[e]) continue;
        excluded_[e] = 1;
        decision.excluded.push_back(e);
      }
    }
  }
}

PressedNodes SplitCracks::pressed_nodes(const Press& press,
                                        std::span<const std::uint8_t> destroyed) const {
  if (press.crack < 0 || static_cast<std::size_t>(press.crack) >= cracks_.size()) return {};
  return fracture::pressed_nodes(board_, cracks_[static_cast<std::size_t>(press.crack)], press,
                                 destroyed);
}

/// Nodes of a face in the order in which its normal leaves its element.
std::array<Index, 3> SplitCracks::outward(const Face& face) const {
  std::array<Index, 3> nodes = body_.nodes(face);
  const auto at = [&](Index n) -> const Vec3& {
    return problem_.mesh().nodes[static_cast<std::size_t>(body_.in_mesh(n))];
  };
  const Index opposite = body_.corners(face.element)[static_cast<std::size_t>(face.opposite)];
  const Vec3 normal = (at(nodes[1]) - at(nodes[0])).cross(at(nodes[2]) - at(nodes[0]));
  if (normal.dot(at(opposite) - at(nodes[0])) > 0) std::swap(nodes[1], nodes[2]);
  return nodes;
}

std::vector<CrackFace> SplitCracks::faces() const {
  std::vector<CrackFace> all;
  for (const Crack& crack : cracks_) {
    for (const Face& face : splits_[static_cast<std::size_t>(crack.id)].faces) {
      CrackFace both;
      both.crack = crack.id;
      both.left = outward(face);
      // The right lip's nodes in the same order: those at the same places of the mesh.
      const auto right = body_.nodes(body_.other_side(face));
      for (std::size_t i = 0; i < 3; ++i) {
        both.right[i] = *std::ranges::find_if(
            right, [&](Index n) { return body_.in_mesh(n) == body_.in_mesh(both.left[i]); });
      }
      all.push_back(both);
    }
  }
  return all;
}

}  // namespace sunder::fracture
