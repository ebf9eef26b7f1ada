// SPDX-License-Identifier: Apache-2.0
// What a change takes from the stiffness between old unknowns and what it adds (method.md
// "Changes").
#include <algorithm>
#include <string>

#include "body/element.hpp"
#include "body/held_together.hpp"
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
      less_.push_back(
          {problem_.mesh().tets[static_cast<std::size_t>(e)], fem::update_factor(problem_, e)});
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
}

/// D element by element: what has come back leaves no rounding of its own stiffness in that of its
/// neighbours.
void Deferred::sum_up_d() {
  d_.topLeftCorner(count(), count()).setZero();
  for (const Part& part : more_) {
    gather({&part, 1});
    if (!rows_.empty()) add_to_d(true);
  }
  for (const Part& part : less_) {
    gather({&part, 1});
    if (!rows_.empty()) add_to_d(false);
  }
}

bool Deferred::follow_border(const fem::Event& event, Eigen::Index columns) {
  if (border_.empty() && forms_.new_nodes().empty()) return true;
  return border_.follow(forms_, event, basis_, compliance_, m_,
                        {column_, columns, changed_, stiffened_});
}

}  // namespace sunder::solver
