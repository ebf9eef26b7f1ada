// SPDX-License-Identifier: Apache-2.0
#include "fracture/combined.hpp"

#include <algorithm>
#include <map>

#include "fem/element.hpp"
#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"
#include "fracture/max_shear.hpp"
#include "fracture/preset_cracks.hpp"
#include "fracture/pressed_nodes.hpp"

namespace sunder::fracture {
namespace {

bool contains(const Decision& decision, Index element) {
  return std::any_of(decision.elements.begin(), decision.elements.end(),
                     [&](const DestroyedElement& row) { return row.element == element; });
}

DestroyedElement growth_row(const Passed& passed, int crack, SifTerms terms) {
  terms.reach = passed.reach;
  DestroyedElement row;
  row.element = passed.element;
  row.cause = Cause::sif;
  row.crack = crack;
  row.ratio = passed.ratio;
  row.sif = terms;
  return row;
}

FieldView field_view(const FractureState& state) {
  return {state.destroyed, state.displacement,
          state.forces ? state.forces() : std::vector<NodalForce>{}};
}

/// The terms of the field with those of the formula beside them.
SifTerms with_formula(SifTerms terms, const SifTerms& formula) {
  terms.k_a = formula.k_a;
  terms.k_b = formula.k_b;
  terms.k_c = formula.k_c;
  terms.sigma0 = formula.sigma0;
  terms.beta = formula.beta;
  terms.a = formula.a;
  terms.b = formula.b;
  terms.k_formula = formula.k_formula;
  terms.theta_formula = formula.theta_formula;
  return terms;
}

bool any_tip_left(const std::vector<Crack>& cracks) {
  return std::any_of(cracks.begin(), cracks.end(), [](const Crack& crack) {
    return std::any_of(crack.tips.begin(), crack.tips.end(),
                       [](const CrackTip& tip) { return !tip.ended; });
  });
}

}  // namespace

Combined::Combined(const Problem& problem)
    : problem_(problem),
      board_(problem.mesh(), problem.scene().fracture.plane_normal),
      meter_(problem, board_),
      excluded_(problem.mesh().tets.size(), 0) {
  for (Index e = 0; e < problem.tet_count() && !anything_breakable_; ++e)
    anything_breakable_ = problem.breakable(e);
}

Decision Combined::preset() {
  const auto& presets = problem_.scene().cracks;
  for (std::size_t c = 0; c < presets.size(); ++c)
    cracks_.push_back(
        preset_crack(board_, presets[c], static_cast<int>(c), problem_.crack_elements()[c]));
  Decision decision;
  decision.elements = preset_elements(problem_);
  exclude_neighbours(decision);
  return decision;
}

Decision Combined::decide(const FractureState& state) {
  Decision decision;
  if (!anything_breakable_) return decision;
  std::vector<DrivenTip> driven = driven_tips(state, decision.warnings);
  for (std::size_t i = 0; i < driven.size(); ++i) grow(driven, i, state, decision);
  if (decision.elements.empty()) start_crack(state, decision);
  exclude_neighbours(decision);
  driven_ = std::move(driven);
  return decision;
}

/// Where a tip wanted to grow at the last decision; straight on when nothing drove it then.
Vec2 Combined::heading(const Crack& crack, std::size_t tip) const {
  for (const auto& [id, growth] : driven_) {
    if (id == crack.id && growth.terms.tip == static_cast<int>(tip)) return growth.direction;
  }
  return crack.tips[tip].direction;
}

/// The band ahead of each tip, in the direction in which it wants to grow, and the element that
/// would start a new crack.
void Combined::next_in_line(const FractureState& state, std::vector<Index>& next) const {
  constexpr std::size_t kAhead = 16;  // of a tip: what an event takes of a thin board
  next.clear();
  const auto add = [&next](Index e) {  // two tips may face the same element
    if (std::find(next.begin(), next.end(), e) == next.end()) next.push_back(e);
  };
  const ElementView view{
      [&](Index e) { return !state.destroyed[e]; },
      [&](Index e) { return problem_.yield(e); },
  };
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      if (crack.tips[tip].ended) continue;
      const Ray ray{crack.tips[tip].position, heading(crack, tip), &crack, orientation(crack, tip)};
      std::size_t taken = 0;
      for (const BandElement& e : find_band(board_, ray, view).elements) {
        if (!problem_.breakable(e.element) || taken++ == kAhead) break;
        add(e.element);
      }
    }
  }
  if (state.summary.candidate.element != kNone) add(state.summary.candidate.element);
}

std::vector<Combined::DrivenTip> Combined::driven_tips(const FractureState& state,
                                                       std::vector<std::string>& warnings) {
  std::vector<DrivenTip> driven;
  if (!any_tip_left(cracks_)) return driven;
  // The remote field of the intact body costs a solve; the field's K does without it.
  std::optional<PristineField> remote;
  if (!by_field()) remote.emplace(problem_, board_, state.pristine_displacement());
  const FieldView view = by_field() ? field_view(state) : FieldView{};
  for (const Crack& crack : cracks_) {
    const FacePressure pressure = face_pressure(board_, crack, state, warnings);
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      if (crack.tips[tip].ended) continue;
      auto growth = by_field() ? field_growth(meter_, crack, tip, view, warnings)
                               : tip_growth(board_, *remote, crack, tip, pressure, state);
      if (growth) driven.push_back({crack.id, std::move(*growth)});
    }
  }
  return driven;
}

void Combined::add_other_terms(std::vector<DrivenTip>& driven, const FractureState& state) {
  std::vector<std::string> untold;  // the notes in the rows say it; nothing rests on these values
  if (!by_field()) {
    if (!state.displacement) return;
    const FieldView view = field_view(state);
    for (auto& [crack, growth] : driven)
      add_field_terms(meter_, cracks_[crack], static_cast<std::size_t>(growth.terms.tip), view,
                      growth.terms, untold);
    return;
  }
  const PristineField remote(problem_, board_, state.pristine_displacement());
  for (auto& [id, growth] : driven) {
    const Crack& crack = cracks_[id];
    const auto tip = static_cast<std::size_t>(growth.terms.tip);
    const FacePressure pressure = face_pressure(board_, crack, state, untold);
    const auto formula = tip_growth(board_, remote, crack, tip, pressure, state);
    growth.terms = with_formula(
        growth.terms,
        formula ? formula->terms : formula_terms(board_, remote, crack, tip, pressure, state));
  }
}

void Combined::grow(std::vector<DrivenTip>& driven, std::size_t which, const FractureState& state,
                    Decision& decision) {
  const TipGrowth& growth = driven[which].growth;
  Crack& crack = cracks_[driven[which].crack];
  CrackTip& tip = crack.tips[growth.terms.tip];
  const int sense = orientation(crack, growth.terms.tip);
  const Ray ray{tip.position, growth.direction, &crack, sense};
  const ElementView view{
      [&](Index e) { return !state.destroyed[e] && !contains(decision, e); },
      [&](Index e) { return problem_.yield(e); },
  };
  const Band band = find_band(board_, ray, view);
  if (band.elements.empty()) {
    tip.ended = true;
    return;
  }
  const Walk walk = walk_band(band, board_.h(), growth.terms.k, growth.theta, view);
  if (walk.passed.empty()) return;
  if (decision.elements.empty()) add_other_terms(driven, state);  // no tip has moved yet
  std::map<Index, std::int8_t> labels;  // all from the sides before this step
  for (const Passed& passed : walk.passed) {
    for (Index n : problem_.mesh().tets[passed.element])
      if (const int side = node_side(board_, ray, band.near_side, n))
        labels[n] = static_cast<std::int8_t>(side * sense);
    crack.elements.push_back(passed.element);
    decision.elements.push_back(growth_row(passed, crack.id, growth.terms));
  }
  for (const auto& [node, side] : labels) crack.side[node] = side;
  advance_tip(crack, growth.terms.tip, growth.direction, walk.advance);
  tip.ended = at_outline(board_, tip.position);
}

void Combined::start_crack(const FractureState& state, Decision& decision) {
  auto row = rupture(state.summary.candidate);
  if (!row) return;
  const InPlane stress = in_plane(state.current_stress(row->element), board_.plane());
  const int id = static_cast<int>(cracks_.size());
  cracks_.push_back(born_crack(board_, row->element, stress, id));
  row->crack = id;
  decision.elements.push_back(*row);
  if (problem_.scene().fracture.birth == CrackBirth::through)
    cut_through(cracks_.back(), state, decision);
}

/// A board is thicker than one element: what lies beside the first one, across the new path, would
/// stay behind as a ligament that carries the whole stress picture.
void Combined::cut_through(Crack& crack, const FractureState& state, Decision& decision) {
  const Vec2 along = crack.path.back() - crack.path.front();
  const Ray ray{crack.path.front(), along.normalized(), &crack, 1};
  const ElementView view{
      [&](Index e) { return !state.destroyed[e] && problem_.breakable(e); },
      [&](Index e) { return problem_.yield(e); },
  };
  const Band band = find_band(board_, ray, view);
  for (const BandElement& beside : band.elements) {
    if (beside.rho > along.norm() || contains(decision, beside.element)) continue;
    DestroyedElement row = decision.elements.front();
    row.element = beside.element;
    row.ratio = fem::yield_measure(state.current_stress(beside.element),
                                   problem_.scene().fracture.yield_measure) /
                problem_.yield(beside.element);
    decision.elements.push_back(row);
    crack.elements.push_back(beside.element);
  }
  std::map<Index, std::int8_t> labels;
  for (Index e : crack.elements) {
    for (Index n : problem_.mesh().tets[e])
      labels[n] = static_cast<std::int8_t>(node_side(board_, ray, band.near_side, n));
  }
  crack.side = std::move(labels);
}

void Combined::exclude_neighbours(Decision& decision) {
  std::vector<Index>& excluded = decision.excluded;
  for (const DestroyedElement& row : decision.elements) {
    for (Index n : problem_.mesh().tets[row.element]) {
      for (Index e : board_.elements_of(n)) {
        if (excluded_[e]) continue;
        excluded_[e] = 1;
        excluded.push_back(e);
      }
    }
  }
  std::sort(excluded.begin(), excluded.end());
}

std::vector<Index> Combined::pressed_nodes(const Press& press,
                                           std::span<const std::uint8_t> destroyed) const {
  if (press.crack < 0 || static_cast<std::size_t>(press.crack) >= cracks_.size()) return {};
  return fracture::pressed_nodes(board_, cracks_[press.crack], press, destroyed);
}

}  // namespace sunder::fracture
