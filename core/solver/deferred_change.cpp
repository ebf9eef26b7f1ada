// SPDX-License-Identifier: Apache-2.0
// What a change takes from the stiffness between old unknowns and what it adds (method.md
// "Changes").
#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

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
}

/// Where volume is pooled: an event may split patches that it does not touch. Its new nodes are
/// known already.
std::unique_ptr<fem::Forms> Deferred::forms_after(const fem::Event& event) const {
  if (!problem_.pools()) return nullptr;
  auto forms = std::make_unique<fem::Forms>(forms_);
  forms->follow(event);
  return forms;
}

/// The patches whose elements an event changes, and those that a piece which comes off parts.
void Deferred::find_patches(const fem::Event& event, const fem::Forms& after) {
  const fem::Pools& whole = *problem_.pools();
  std::vector<Index> changed(event.leave.begin(), event.leave.end());
  for (const fem::Coming& c : event.come) changed.push_back(c.element);
  whole.of(changed, patches_);
  const fem::Pools &was = *forms_.pools(), &is = *after.pools();
  if (&was == &is || was == is) return;
  const std::vector<Index> of_event = patches_;
  for (Index patch = 0; patch < whole.count(); ++patch) {
    if (!std::ranges::binary_search(of_event, patch) &&
        was.parts_of(whole, patch) != is.parts_of(whole, patch)) {
      patches_.push_back(patch);
    }
  }
}

/// What patches exerted, which goes, and what they exert from now on, which comes. So the stiffness
/// of what stays may grow where elements leave, and falls where a patch is split.
void Deferred::collect_pressure(std::span<const Index> patches, const fem::Forms& before,
                                const fem::Forms& after) {
  const fem::Pools& whole = *problem_.pools();
  for (Index patch : patches) {
    const auto changes = [&](Index e) { return before.share(e) != after.share(e); };
    if (std::ranges::none_of(whole.elements(patch), changes) &&
        before.pools()->parts_of(whole, patch) == after.pools()->parts_of(whole, patch)) {
      continue;
    }
    const auto add = [&](const fem::Forms& forms, std::vector<Part>& to) {
      const auto share = [&forms](Index e) { return forms.share(e); };
      fem::append_pressure(problem_, patch, *forms.pools(), share, to);
    };
    add(before, less_);
    add(after, more_);
  }
}

/// More stiffness first: then both small matrices are definite wherever the body is. Where the last
/// digits of M decide otherwise, all changes so far are taken at once.
bool Deferred::apply(const fem::Event& event, fem::Forms* after) {
  collect(event);
  if (after) {
    find_patches(event, *after);
    collect_pressure(patches_, forms_, *after);
  }
  const auto follow = [&] {
    if (after) forms_ = std::move(*after);
    if (!after) forms_.follow(event);
  };
  if (less_.empty() && more_.empty()) {  // splits alone change nothing between old unknowns
    follow();
    if (event.of_grips()) find_grips();
    stiffened_ = false;
    return true;
  }
  stiffened_ = true;
  const bool destroys = event.come.empty() && forms_.came().empty();
  const bool followed = update_both();
  follow();
  if (destroys || (followed && event.come.empty())) return followed;
  collect_all();
  if (!followed || (less_.empty() && more_.empty())) clear();
  if (!followed && !update_both()) return false;
  sum_up_d();
  return true;
}

bool Deferred::update_both() {
  if (!more_.empty() && !update(more_, true)) return false;
  if (less_.empty()) return true;
  // Who solves elsewhere is told of the second with the grips as the first has left them.
  const bool of_grips = elsewhere_ && !more_.empty() && border_.empty();
  return (!of_grips || factor_grips()) && update(less_, false);
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
  std::vector<Index> all(static_cast<std::size_t>(problem_.pools()->count()));
  std::iota(all.begin(), all.end(), 0);
  collect_pressure(all, in_base_, forms_);
}

/// D element by element: what has come back leaves no rounding of its own stiffness in that of its
/// neighbours.
void Deferred::sum_up_d() {
  if (elsewhere_) elsewhere_->forget();
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
                        {column_, columns, changed_, stiffened_, patches_});
}

}  // namespace sunder::solver
