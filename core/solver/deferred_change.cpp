// SPDX-License-Identifier: Apache-2.0
// What a change takes from the stiffness between old unknowns and what it adds (method.md
// "Changes").
#include <algorithm>
#include <string>

#include "body/element.hpp"
#include "body/held_together.hpp"
#include "body/pools.hpp"
#include "solver/deferred.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {

bool Deferred::change(const fem::Event& change) {
  check(forms_, change);
  if (fem::reverses_last(in_base_, damage_, forms_, change)) {
    take_back();
    return true;
  }
  if (!fem::holds_together(forms_, change)) return false;
  damage_.add(change);
  return follow_last();
}

Index Deferred::unknown(Index node, int axis) const {
  if (node < problem_.node_count()) return problem_.dof(node, axis);
  if (node >= forms_.node_count()) throw UsageError("there is no node " + std::to_string(node));
  const Index own = border_.unknowns().unknown(node - problem_.node_count(), axis);
  return own == kNone ? kNone : base_->size() + own;
}

/// Nodes of the mesh between which an element's stiffness acts in A.
std::array<Index, 4> Deferred::glued(Index element) const {
  const auto form = forms_.came().find(element);
  if (form == forms_.came().end()) return problem_.mesh().tets[static_cast<std::size_t>(element)];
  return forms_.parents(form->second.corners);
}

void Deferred::collect(const fem::StiffnessDifference& between) {
  if (between.less) less_.push_back(*between.less);
  if (between.more) more_.push_back(*between.more);
}

void Deferred::collect(const fem::Event& event) {
  less_.clear();
  more_.clear();
  for (Index e : event.leave) {
    const auto comes = [e](const fem::Coming& c) { return c.element == e; };
    if (std::ranges::any_of(event.come, comes)) continue;  // below
    if (!forms_.came().contains(e)) {
      less_.push_back({problem_.mesh().tets[static_cast<std::size_t>(e)],
                       fem::update_factor(problem_, e), kNone});
      continue;
    }
    fem::Form gone = forms_.of(e);
    gone.share = problem_.scene().fracture.alpha;
    collect(fem::difference(forms_, forms_.of(e), gone));
  }
  for (const fem::Coming& c : event.come) {
    fem::Form before = c.form;
    before.share = 0;
    if (c.element < forms_.element_count()) before = forms_.of(c.element);
    collect(fem::difference(forms_, before, c.form));
  }
  if (problem_.pools()) collect_pressure(event);
}

/// Of the patches whose elements an event changes: what they exerted, which goes, and what they
/// exert after it, which comes. So the stiffness of what stays may grow where elements leave, and
/// falls where a crack splits a patch.
void Deferred::collect_pressure(const fem::Event& event) {
  pooled_.assign(event.leave.begin(), event.leave.end());
  for (const fem::Coming& c : event.come) pooled_.push_back(c.element);
  problem_.pools()->of(pooled_, patches_);
  const double alpha = problem_.scene().fracture.alpha;
  const auto before = [this](Index e) { return forms_.share(e); };
  const auto after = [&](Index e) {
    const auto came = std::ranges::find(event.come, e, &fem::Coming::element);
    if (came != event.come.end()) return came->form.share;
    return std::ranges::find(event.leave, e) != event.leave.end() ? alpha : forms_.share(e);
  };
  const auto corners = [this](Index e) -> const std::array<Index, 4>& { return forms_.corners(e); };
  const auto corners_after = [&](Index e) -> const std::array<Index, 4>& {
    const auto came = std::ranges::find(event.come, e, &fem::Coming::element);
    return came != event.come.end() ? came->form.corners : forms_.corners(e);
  };
  collect_pressure(patches_, {corners, before}, {corners_after, after});
}

/// Of those patches that are not the same: their elements' shares differ, or which of them hang
/// together.
void Deferred::collect_pressure(std::span<const Index> patches, const PatchState& before,
                                const PatchState& after) {
  const fem::Pools& pools = *problem_.pools();
  for (Index patch : patches) {
    const auto changes = [&](Index e) { return before.share(e) != after.share(e); };
    if (std::ranges::none_of(pools.elements(patch), changes) &&
        pools.parts(patch, before.corners) == pools.parts(patch, after.corners)) {
      continue;
    }
    fem::append_pressure(problem_, patch, before.corners, before.share, less_);
    fem::append_pressure(problem_, patch, after.corners, after.share, more_);
  }
}

/// More stiffness first: then both small matrices are definite wherever the body is. Where the last
/// digits of M decide otherwise, all changes so far are taken at once.
bool Deferred::apply(const fem::Event& event) {
  collect(event);
  if (less_.empty() && more_.empty()) {  // splits alone change nothing between old unknowns
    forms_.follow(event);
    if (event.of_grips()) find_grips();
    stiffened_ = false;
    return true;
  }
  stiffened_ = true;
  const bool destroys = event.come.empty() && forms_.came().empty();
  const bool followed = update_both();
  forms_.follow(event);
  if (destroys || (followed && event.come.empty())) return followed;
  collect_all();
  if (!followed || (less_.empty() && more_.empty())) clear();
  if (!followed && !update_both()) return false;
  sum_up_d();
  return true;
}

bool Deferred::update_both() {
  return (more_.empty() || update(more_, true)) && (less_.empty() || update(less_, false));
}

/// All that differs from what the base has.
void Deferred::collect_all() {
  less_.clear();
  more_.clear();
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (!forms_.came().contains(e)) collect(fem::difference(in_base_, forms_, e));
  }
  for (const auto& [element, form] : forms_.came()) {
    collect(fem::difference(in_base_, forms_, element));
  }
  if (!problem_.pools()) return;
  pooled_.clear();
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    if (in_base_.share(e) != forms_.share(e) || in_base_.corners(e) != forms_.corners(e)) {
      pooled_.push_back(e);
    }
  }
  problem_.pools()->of(pooled_, patches_);
  const auto of = [](const fem::Forms& forms) {
    return PatchState{[&forms](Index e) -> const std::array<Index, 4>& { return forms.corners(e); },
                      [&forms](Index e) { return forms.share(e); }};
  };
  collect_pressure(patches_, of(in_base_), of(forms_));
}

/// D element by element: what has come back leaves no rounding of its own stiffness in that of its
/// neighbours.
void Deferred::sum_up_d() {
  d_.topLeftCorner(count(), count()).setZero();
  sum_up_d(more_, true);
  sum_up_d(less_, false);
}

void Deferred::sum_up_d(std::span<const Part> parts, bool more) {
  for (std::size_t begin = 0, end = 0; begin < parts.size(); begin = end) {
    const Index patch = parts[begin].patch;
    for (end = begin + 1; end < parts.size() && patch != kNone && parts[end].patch == patch;) ++end;
    gather(parts.subspan(begin, end - begin));
    if (!rows_.empty()) add_to_d(more);
  }
}

bool Deferred::follow_border(const fem::Event& event, Eigen::Index columns) {
  if (border_.empty() && forms_.new_nodes().empty()) return true;
  return border_.follow(forms_, event, basis_, compliance_, m_,
                        {column_, columns, changed_, stiffened_});
}

}  // namespace sunder::solver
