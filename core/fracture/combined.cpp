// SPDX-License-Identifier: Apache-2.0
#include "fracture/combined.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fracture/crack_birth.hpp"
#include "fracture/crack_path.hpp"
#include "fracture/preset_cracks.hpp"
#include "fracture/pressed_nodes.hpp"
#include "fracture/stress_intensity.hpp"
#include "fracture/worst_element.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::fracture {
namespace {

// Of lists that cracks share [bytes]: what an element adds at most, as vectors grow by doubling
// (four labels of 40, a point, its id), up to some 60,000 elements.
constexpr std::size_t kOfAnElement = 256, kMostOfCracks = std::size_t{1} << 24;

// Tips that move in one event, as room for its rows.
constexpr std::size_t kTipsAtOnce = 16;

std::vector<double> yields_of(const Problem& problem) {
  std::vector<double> yields(problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) yields[e] = problem.yield(e);
  return yields;
}

std::size_t room_for_cracks(const Problem& problem) {
  std::size_t destructible = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) destructible += problem.destructible(e) ? 1 : 0;
  return std::min(kOfAnElement * (destructible + 1), kMostOfCracks);
}

DestroyedElement growth_row(const Passed& passed, int crack, SifTerms terms) {
  terms.reach = passed.reach;
  if (passed.toughness > 0) terms.toughness = passed.toughness;
  DestroyedElement row;
  row.element = passed.element;
  row.cause = Cause::sif;
  row.crack = crack;
  row.ratio = passed.ratio;
  row.sif = terms;
  return row;
}

FieldView field_view(const FractureState& state) {
  FieldView view{state.destroyed, state.displacement,
                 state.forces ? state.forces() : std::span<const NodalForce>{}};
  view.pools = state.pools;
  return view;
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
  terms.at = formula.at;
  terms.d = formula.d;
  terms.e_a = formula.e_a;
  terms.e_c = formula.e_c;
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
      yields_(yields_of(problem)),
      toughness_(problem, board_),
      lists_(room_for_cracks(problem)),
      excluded_(problem.mesh().tets.size(), 0),
      pristine_(problem, board_, {}),
      present_(problem, board_),
      bands_(board_),
      taken_(problem.mesh().tets.size(), 0) {
  for (Index e = 0; e < problem.tet_count() && !anything_destructible_; ++e)
    anything_destructible_ = problem.destructible(e);
  // Births share no node with one another.
  cracks_.reserve(problem.scene().cracks.size() + problem.mesh().nodes.size() / 4 + 1);
  driven_.reserve(2 * std::min(cracks_.capacity(), kTipsAtOnce * kTipsAtOnce));
  walk_.passed.reserve(bands_.most());
  labels_.reserve(4 * bands_.most());
  faces_.pushes.reserve(problem.scene().instruments.size());
  untold_.reserve(driven_.capacity());
}

std::shared_ptr<const CriterionState> Combined::state() const {
  if (!kept_) kept_ = std::make_shared<const Kept>(Kept{cracks_, excluded_});
  auto state = std::make_shared<State>();
  state->kept = kept_;
  state->driven = driven_;
  return state;
}

/// Cracks keep the room that they have; what was born since goes.
void Combined::restore(const CriterionState& of) {
  const auto& state = dynamic_cast<const State&>(of);
  const std::vector<Crack>& cracks = state.kept->cracks;
  const std::size_t same = std::min(cracks.size(), cracks_.size());
  cracks_.erase(cracks_.begin() + static_cast<std::ptrdiff_t>(same), cracks_.end());
  std::copy_n(cracks.begin(), same, cracks_.begin());
  for (std::size_t c = same; c < cracks.size(); ++c) {
    cracks_.emplace_back(&lists_);
    cracks_.back() = cracks[c];
  }
  excluded_ = state.kept->excluded;
  driven_ = state.driven;
  kept_ = state.kept;
}

Decision Combined::preset() {
  kept_.reset();
  const auto& presets = problem_.scene().cracks;
  for (std::size_t c = 0; c < presets.size(); ++c)
    cracks_.push_back(preset_crack(board_, presets[c], static_cast<int>(c),
                                   problem_.crack_elements()[c], &lists_));
  Decision decision;
  decision.elements = preset_elements(problem_);
  exclude_neighbours(decision);
  return decision;
}

/// Nothing from the second time on.
void Combined::reserve(Decision& decision) const {
  decision.elements.reserve(std::min(kTipsAtOnce * bands_.most(), yields_.size()));
  decision.excluded.reserve(yields_.size());
  decision.findings.reserve(driven_.capacity());
}

void Combined::decide(const FractureState& state, Decision& decision) {
  decision.clear();
  reserve(decision);
  if (!anything_destructible_) return;
  drive_tips(state, decision.findings);
  for (const DrivenTip& driven : driven_) grow(driven, state, decision);
  if (decision.elements.empty()) start_crack(state, decision);
  for (const DestroyedElement& row : decision.elements) taken_[row.element] = 0;
  exclude_neighbours(decision);
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
void Combined::next_in_line(const FractureState& state, std::vector<Index>& next) {
  constexpr std::size_t kAhead = 16;  // of a tip: what an event takes of a thin board
  next.clear();
  const auto add = [&next](Index e) {  // two tips may face the same element
    if (std::find(next.begin(), next.end(), e) == next.end()) next.push_back(e);
  };
  const ElementView view{state.destroyed, yields_};
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      if (crack.tips[tip].ended) continue;
      const Ray ray{crack.tips[tip].position, heading(crack, tip), &crack, orientation(crack, tip)};
      std::size_t taken = 0;
      for (const BandElement& e : bands_.find(ray, view).elements) {
        if (!problem_.destructible(e.element) || taken++ == kAhead) break;
        add(e.element);
      }
    }
  }
  if (state.summary.candidate.element != kNone) add(state.summary.candidate.element);
}

const RemoteField& Combined::remote_field(const FractureState& state) {
  if (problem_.scene().fracture.sigma0 == RemoteStress::present) {
    present_.take(state.destroyed, state.displacement, state.pools);
    return present_;
  }
  pristine_.take(state.pristine_displacement());
  return pristine_;
}

void Combined::drive_tips(const FractureState& state, std::vector<Finding>& findings) {
  driven_.clear();
  if (!any_tip_left(cracks_)) return;
  // The remote field of the intact body costs a solve; the field's K does without it.
  const RemoteField* remote = by_field() ? nullptr : &remote_field(state);
  FieldView view = by_field() ? field_view(state) : FieldView{};
  for (const Crack& crack : cracks_) {
    face_pressure(board_, crack, state, findings, faces_);
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      if (crack.tips[tip].ended) continue;
      if (!by_field() && !formula_holds(crack, findings)) continue;
      const auto growth =
          by_field() ? field_growth(meter_, crack, tip, at_tip(view, crack, tip, state), findings)
                     : tip_growth(board_, *remote, crack, tip, faces_, state);
      if (growth) driven_.push_back({crack.id, *growth});
    }
  }
}

/// The remote stress is that of the mesh without what the crack has destroyed: of a crack that is
/// part of the mesh it is what the crack itself leaves beside its faces and heaps up at its tip.
bool Combined::formula_holds(const Crack& crack, std::vector<Finding>& findings) const {
  const Notch* notch = nullptr;
  for (std::size_t tip = 0; tip < crack.tips.size() && !notch; ++tip)
    notch = meter_.notch_of(crack, tip);
  if (!notch) return true;
  findings.push_back(
      {notch->closed ? Finding::Kind::formula_split : Finding::Kind::formula_notch, crack.id});
  return notch->closed;
}

void Combined::tips(const FractureState& state, std::vector<TipState>& tips,
                    std::vector<Finding>& findings) {
  const bool formula = !by_field() && anything_destructible_ && any_tip_left(cracks_);
  const RemoteField* remote = formula ? &remote_field(state) : nullptr;
  FieldView view = by_field() ? field_view(state) : FieldView{};
  for (const Crack& crack : cracks_) {
    for (std::size_t tip = 0; tip < crack.tips.size(); ++tip) {
      tips.push_back(tip_state(board_, crack, tip));
      if (crack.tips[tip].ended) continue;
      if (by_field())
        add_field_state(meter_, crack, tip, at_tip(view, crack, tip, state), tips.back(), findings);
      else if (remote)
        add_formula_state(*remote, crack, state, tips.back(), findings);
      add_toughness(crack, state, tips.back());
    }
  }
}

double Combined::young_at(const Crack& crack, std::size_t tip, const FractureState& state) {
  if (!toughness_.by_energy()) return 0;
  return meter_.material_at(crack, tip, {state.destroyed, {}, {}}).effective_young();
}

const FieldView& Combined::at_tip(FieldView& view, const Crack& crack, std::size_t tip,
                                  const FractureState& state) {
  if (toughness_.by_direction()) {
    view.resistance =
        toughness_.around(crack.tips[tip].position, young_at(crack, tip, state), state.destroyed);
  }
  return view;
}

/// Of the element that is judged first when the tip grows.
void Combined::add_toughness(const Crack& crack, const FractureState& state, TipState& tip) {
  if (!toughness_.any()) return;
  const auto at = static_cast<std::size_t>(tip.tip);
  const double theta = tip.theta.value_or(0.0) * std::numbers::pi / 180;
  const CrackTip& end = crack.tips[at];
  const Ray ray{end.position, turned(end.direction, theta), &crack, orientation(crack, at)};
  ElementView view{state.destroyed, yields_};
  const TipMaterial material = meter_.material_at(crack, at, {state.destroyed, {}, {}});
  view.toughness = toughness_.view(material.effective_young(), ray.direction);
  const Band& band = bands_.find(ray, view);
  if (band.elements.empty()) return;
  const double k_c = view.toughness.of(band.elements.front().element);
  if (!(k_c > 0)) return;
  tip.toughness = k_c;
  tip.toughness_state = material.constraint > 0 ? "plane strain" : "plane stress";
}

void Combined::add_formula_state(const RemoteField& remote, const Crack& crack,
                                 const FractureState& state, TipState& tip,
                                 std::vector<Finding>& findings) {
  if (!formula_holds(crack, findings)) {
    tip.field_note = "notch";
    return;
  }
  const auto at = static_cast<std::size_t>(tip.tip);
  face_pressure(board_, crack, state, findings, faces_);
  const auto growth = tip_growth(board_, remote, crack, at, faces_, state);
  tip.k = growth ? growth->terms.k : 0.0;
  if (growth) tip.theta = growth->terms.theta;
}

void Combined::add_other_terms(const FractureState& state) {
  untold_.clear();  // the notes in the rows say it; nothing rests on these values
  if (!by_field()) {
    if (!state.displacement) return;
    const FieldView view = field_view(state);
    for (auto& [crack, growth] : driven_)
      add_field_terms(meter_, cracks_[crack], static_cast<std::size_t>(growth.terms.tip), view,
                      growth.terms, untold_);
    return;
  }
  const RemoteField& remote = remote_field(state);
  for (auto& [id, growth] : driven_) {
    const Crack& crack = cracks_[id];
    const auto tip = static_cast<std::size_t>(growth.terms.tip);
    if (!formula_holds(crack, untold_)) continue;
    face_pressure(board_, crack, state, untold_, faces_);
    const auto formula = tip_growth(board_, remote, crack, tip, faces_, state);
    growth.terms = with_formula(
        growth.terms,
        formula ? formula->terms : formula_terms(board_, remote, crack, tip, faces_, state));
  }
}

void Combined::take(const DestroyedElement& row, Decision& decision) {
  kept_.reset();
  taken_[row.element] = 1;
  decision.elements.push_back(row);
}

void Combined::grow(const DrivenTip& driven, const FractureState& state, Decision& decision) {
  const TipGrowth& growth = driven.growth;
  Crack& crack = cracks_[driven.crack];
  CrackTip& tip = crack.tips[growth.terms.tip];
  const int sense = orientation(crack, growth.terms.tip);
  const Ray ray{tip.position, growth.direction, &crack, sense};
  const double young = young_at(crack, static_cast<std::size_t>(growth.terms.tip), state);
  const ToughnessView toughness = toughness_.view(young, growth.direction);
  const ElementView view{state.destroyed, yields_, taken_, false, toughness};
  const Band& band = bands_.find(ray, view);
  if (band.elements.empty()) {
    kept_.reset();
    tip.ended = true;
    return;
  }
  walk_band(band, board_.h(), growth.terms.k, growth.theta, view, walk_);
  if (walk_.passed.empty()) return;
  if (decision.elements.empty()) add_other_terms(state);  // no tip has moved yet
  SifTerms terms = growth.terms;
  terms.advance = walk_.advance;
  labels_.clear();  // all from the sides before this step
  for (const Passed& passed : walk_.passed) {
    for (Index n : problem_.mesh().tets[passed.element])
      if (const int side = node_side(board_, ray, band.near_side, n))
        labels_.emplace_back(n, static_cast<std::int8_t>(side * sense));
    crack.elements.push_back(passed.element);
    take(growth_row(passed, crack.id, terms), decision);
  }
  for (const auto& [node, side] : labels_) crack.side[node] = side;
  advance_tip(crack, growth.terms.tip, growth.direction, walk_.advance);
  tip.ended = at_outline(board_, tip.position);
}

void Combined::start_crack(const FractureState& state, Decision& decision) {
  auto row = rupture(state.summary.candidate, Cause::mss);
  if (!row) return;
  const InPlane stress = in_plane(state.current_stress(row->element), board_.plane());
  const int id = static_cast<int>(cracks_.size());
  cracks_.push_back(born_crack(board_, row->element, stress, id, &lists_));
  row->crack = id;
  take(*row, decision);
  if (problem_.scene().fracture.birth == CrackBirth::through)
    cut_through(cracks_.back(), state, decision);
}

/// A board is thicker than one element: what lies beside the first one, across the new path, would
/// stay behind as a ligament that carries the whole stress picture.
void Combined::cut_through(Crack& crack, const FractureState& state, Decision& decision) {
  const Vec2 along = crack.path.back() - crack.path.front();
  const Ray ray{crack.path.front(), along.normalized(), &crack, 1};
  const Band& band = bands_.find(ray, {state.destroyed, yields_, {}, true});
  for (const BandElement& beside : band.elements) {
    if (beside.rho > along.norm() || taken_[beside.element]) continue;
    DestroyedElement row = decision.elements.front();
    row.element = beside.element;
    row.ratio = yield_measure(state.current_stress(beside.element),
                              strength_measure(problem_.scene().fracture)) /
                problem_.yield(beside.element);
    take(row, decision);
    crack.elements.push_back(beside.element);
  }
  labels_.clear();
  for (Index e : crack.elements) {
    for (Index n : problem_.mesh().tets[e])
      labels_.emplace_back(n, static_cast<std::int8_t>(node_side(board_, ray, band.near_side, n)));
  }
  for (const auto& [node, side] : labels_) crack.side[node] = side;
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

PressedNodes Combined::pressed_nodes(const Press& press,
                                     std::span<const std::uint8_t> destroyed) const {
  if (press.crack < 0 || static_cast<std::size_t>(press.crack) >= cracks_.size()) return {};
  return fracture::pressed_nodes(board_, cracks_[press.crack], press, destroyed);
}

}  // namespace sunder::fracture
