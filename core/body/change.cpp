// SPDX-License-Identifier: Apache-2.0
#include "body/change.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "body/element.hpp"
#include "sunder/error.hpp"

namespace sunder::fem {
namespace {

bool same(const SmallStrain& a, const SmallStrain& b) {
  return a.young == b.young && a.poisson == b.poisson && a.lambda == b.lambda && a.mu == b.mu;
}

bool same(const TetShape& a, const TetShape& b) {
  return a.volume == b.volume && a.gradient == b.gradient;
}

bool same(const Form& a, const Form& b) {
  return a.corners == b.corners && a.share == b.share && same(a.shape, b.shape) &&
         same(a.law, b.law);
}

/// The forms that a change gives to elements.
std::map<Index, Form> outcome(const Forms& forms, const Event& change) {
  std::map<Index, Form> forms_after;
  for (Index e : change.leave) {
    Form form = forms.of(e);
    form.share = forms.problem().scene().fracture.alpha;
    forms_after[e] = form;
  }
  for (const Coming& c : change.come) forms_after[c.element] = c.form;
  return forms_after;
}

[[noreturn]] void refuse(const std::string& what, Index id, const std::string& why) {
  throw UsageError(what + " " + std::to_string(id) + " " + why);
}

void check_form(const Coming& coming, Index nodes) {
  const Form& form = coming.form;
  for (Index n : form.corners) {
    if (n < 0 || n >= nodes) {
      refuse("element", coming.element,
             "cannot come: there is no node " + std::to_string(n) + " for a corner of it");
    }
  }
  if (!(form.share >= 0 && std::isfinite(form.share))) {
    refuse("element", coming.element, "cannot come: its share of stiffness must be 0 or more");
  }
  if (!(form.shape.volume > 0)) {
    refuse("element", coming.element, "cannot come: its volume must be positive");
  }
}

}  // namespace

void Damage::reserve(std::size_t elements, std::size_t events) {
  leave_.reserve(elements);
  ends_.reserve(events);
}

void Damage::add(const Event& event) {
  leave_.insert(leave_.end(), event.leave.begin(), event.leave.end());
  come_.insert(come_.end(), event.come.begin(), event.come.end());
  nodes_.insert(nodes_.end(), event.nodes.begin(), event.nodes.end());
  ties_.insert(ties_.end(), event.ties.begin(), event.ties.end());
  grasp_.insert(grasp_.end(), event.grasp.begin(), event.grasp.end());
  release_.insert(release_.end(), event.release.begin(), event.release.end());
  const auto size = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  ends_.push_back(
      {size(leave_), size(come_), size(nodes_), size(ties_), size(grasp_), size(release_)});
}

void Damage::take_back() {
  ends_.pop_back();
  const End end = ends_.empty() ? End{} : ends_.back();
  leave_.resize(end.leave);
  come_.resize(end.come);
  nodes_.resize(end.nodes);
  ties_.resize(end.ties);
  grasp_.resize(end.grasp);
  release_.resize(end.release);
}

Event Damage::operator[](std::size_t i) const {
  const End begin = i == 0 ? End{} : ends_[i - 1], end = ends_[i];
  const auto part = [](const auto& list, std::size_t from, std::size_t to) {
    return std::span(list).subspan(from, to - from);
  };
  return {part(leave_, begin.leave, end.leave),
          part(come_, begin.come, end.come),
          part(nodes_, begin.nodes, end.nodes),
          part(ties_, begin.ties, end.ties),
          false,
          part(grasp_, begin.grasp, end.grasp),
          part(release_, begin.release, end.release)};
}

Forms::Forms(const Problem& problem)
    : problem_(&problem),
      destroyed_(static_cast<std::size_t>(problem.tet_count()), 0),
      gripped_(problem.gripped_dofs().begin(), problem.gripped_dofs().end()),
      own_gripped_(gripped_.size()) {}

void Forms::add(std::span<const NewNode> nodes) {
  nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
}

void Forms::follow(const Event& event, bool more) {
  for (Index d : event.release) {
    const auto at = std::ranges::find(gripped_, d);
    if (at == gripped_.end()) continue;
    if (at - gripped_.begin() < static_cast<std::ptrdiff_t>(own_gripped_)) --own_gripped_;
    gripped_.erase(at);
  }
  gripped_.insert(gripped_.end(), event.grasp.begin(), event.grasp.end());
  for (const Tie& tie : event.ties) {
    NewNode& node = nodes_[static_cast<std::size_t>(tie.node - problem_->node_count())];
    node.tie = tie.stiffness;
    node.spring = tie.spring;
  }
  const double alpha = problem_->scene().fracture.alpha;
  for (Index e : event.leave) {
    if (e < problem_->tet_count()) destroyed_[static_cast<std::size_t>(e)] = 1;
    const auto form = came_.find(e);
    if (form != came_.end()) form->second.share = alpha;
  }
  for (const Coming& c : event.come) {
    came_[c.element] = c.form;
    if (c.element >= problem_->tet_count()) continue;
    destroyed_[static_cast<std::size_t>(c.element)] = c.form.share > alpha ? 0 : 1;
  }
  if (!problem_->pools()) return;
  changed_.insert(changed_.end(), event.leave.begin(), event.leave.end());
  for (const Coming& c : event.come) changed_.push_back(c.element);
  if (!more && !changed_.empty()) split_pools();
}

void Forms::split_pools() {
  std::vector<Index> split;
  const auto& tets = problem_->mesh().tets;
  for (const auto& [element, form] : came_) {
    if (element < problem_->tet_count() && form.corners != tets[static_cast<std::size_t>(element)])
      split.push_back(element);
  }
  const auto corners_of = [this](Index e) -> const std::array<Index, 4>& { return corners(e); };
  pools_.follow({*problem_, destroyed_, corners_of, split}, changed_);
  changed_.clear();
}

Index Forms::element_count() const {
  return came_.empty() ? problem_->tet_count()
                       : std::max(problem_->tet_count(), came_.rbegin()->first + 1);
}

Index Forms::node_count() const {
  return problem_->node_count() + static_cast<Index>(nodes_.size());
}

double Forms::share(Index element) const {
  const auto form = came_.find(element);
  if (form != came_.end()) return form->second.share;
  if (element >= problem_->tet_count()) return 0;
  return destroyed_[static_cast<std::size_t>(element)] ? problem_->scene().fracture.alpha : 1;
}

Form Forms::of(Index element) const {
  const auto form = came_.find(element);
  if (form != came_.end()) return form->second;
  Form in_mesh = form_in_mesh(*problem_, element);
  in_mesh.share = share(element);
  return in_mesh;
}

const std::array<Index, 4>& Forms::corners(Index element) const {
  const auto form = came_.find(element);
  return form != came_.end() ? form->second.corners
                             : problem_->mesh().tets[static_cast<std::size_t>(element)];
}

std::array<Index, 4> Forms::parents(const std::array<Index, 4>& corners) const {
  std::array<Index, 4> nodes = corners;
  for (Index& n : nodes) {
    const Index added = n - problem_->node_count();
    if (added >= 0) n = nodes_[static_cast<std::size_t>(added)].parent;
  }
  return nodes;
}

Form form_in_mesh(const Problem& problem, Index element) {
  return {problem.mesh().tets[static_cast<std::size_t>(element)], problem.shape(element),
          own_law(problem, element), 1};
}

bool same_matter(const Forms& forms, const Form& a, const Form& b) {
  return forms.parents(a.corners) == forms.parents(b.corners) && same(a.shape, b.shape) &&
         same(a.law, b.law);
}

void check(const Forms& forms, const Event& change) {
  const double alpha = forms.problem().scene().fracture.alpha;
  std::set<Index> leaving, coming;
  for (Index e : change.leave) {
    if (e < 0 || e >= forms.element_count()) refuse("element", e, "cannot leave: there is none");
    if (!(forms.share(e) > alpha)) refuse("element", e, "cannot leave: it has left already");
    if (!leaving.insert(e).second) refuse("element", e, "cannot leave twice in one change");
  }
  for (const NewNode& n : change.nodes) {
    if (n.parent < 0 || n.parent >= forms.problem().node_count()) {
      refuse("node", n.parent, "cannot be a parent: it is no node of the mesh");
    }
  }
  const Index first = forms.problem().node_count();
  const Index end = forms.node_count() + static_cast<Index>(change.nodes.size());
  for (const Tie& tie : change.ties) {
    if (tie.node < first || tie.node >= end)
      refuse("node", tie.node, "has no parent to be tied to");
    if (!(tie.stiffness >= 0 && std::isfinite(tie.stiffness))) {
      refuse("node", tie.node, "cannot be tied: the stiffness must be 0 or more");
    }
    if (!tie.spring.allFinite()) {
      refuse("node", tie.node, "cannot be kept apart: the spring must be finite");
    }
  }
  Index beyond = forms.element_count();
  for (const Coming& c : change.come) {
    if (c.element < 0 || c.element > beyond) {
      refuse("element", c.element, "cannot come: the next new id is " + std::to_string(beyond));
    }
    if (!coming.insert(c.element).second) refuse("element", c.element, "cannot come twice");
    if (c.element == beyond) ++beyond;
    check_form(c, forms.node_count() + static_cast<Index>(change.nodes.size()));
  }
}

Change reverse(Forms before, const Damage& damage, std::size_t i) {
  for (std::size_t j = 0; j < i; ++j) {
    before.add(damage[j].nodes);
    before.follow(damage[j], true);
  }
  const Event event = damage[i];
  std::map<Index, Form> forms;
  for (const Coming& c : event.come) {
    Form form = c.form;
    form.share = 0;
    forms[c.element] = c.element < before.element_count() ? before.of(c.element) : form;
  }
  for (Index e : event.leave) forms[e] = before.of(e);
  Change change;
  for (const auto& [element, form] : forms) change.come.push_back({element, form});
  for (const Tie& tie : event.ties) {
    const auto at = static_cast<std::size_t>(tie.node - before.problem().node_count());
    const bool is_new = at >= before.new_nodes().size();
    const NewNode had = is_new ? NewNode{} : before.new_nodes()[at];
    change.ties.push_back({tie.node, had.tie, had.spring});
  }
  return change;
}

bool reverses_last(const Forms& first, const Damage& damage, const Forms& forms,
                   const Event& change) {
  if (damage.size() == 0 || !change.nodes.empty()) return false;
  const auto asked = outcome(forms, change);
  const Change reversed = reverse(first, damage, damage.size() - 1);
  const auto back = outcome(forms, reversed);
  const auto same_tie = [](const Tie& a, const Tie& b) {
    return a.node == b.node && a.stiffness == b.stiffness && a.spring == b.spring;
  };
  if (!std::ranges::equal(change.ties, reversed.ties, same_tie)) return false;
  return std::ranges::equal(asked, back, [](const auto& a, const auto& b) {
    return a.first == b.first && same(a.second, b.second);
  });
}

}  // namespace sunder::fem
