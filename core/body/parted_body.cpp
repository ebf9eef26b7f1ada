// SPDX-License-Identifier: Apache-2.0
#include "body/parted_body.hpp"

#include <algorithm>
#include <iterator>

namespace sunder::fem {

std::shared_ptr<const Problem> parted_problem(const DamagedBody& body) {
  return parted_problem(body, body.problem());
}

std::shared_ptr<const Problem> parted_problem(const DamagedBody& body, const Problem& problem) {
  std::vector<std::array<Index, 4>> corners = problem.mesh().tets;
  for (const auto& [element, form] : body.forms().came()) {
    corners[static_cast<std::size_t>(element)] = form.corners;
  }
  std::vector<NodeThatParts> nodes;
  for (const NewNode& node : body.forms().new_nodes()) nodes.push_back({node.parent, node.axes});
  return std::make_shared<const Problem>(problem, std::move(corners), nodes);
}

bool can_be_parted(const DamagedBody& body) {
  const Problem& problem = body.problem();
  // Springs between lips are ties of offsets, at any later time.
  if (problem.scene().fracture.contact) return false;
  std::vector<std::uint8_t> used(body.forms().new_nodes().size(), 0);
  for (const auto& [element, form] : body.forms().came()) {
    for (Index n : form.corners) {
      if (n >= problem.node_count() && form.share > 0) {
        used[static_cast<std::size_t>(n - problem.node_count())] = 1;
      }
    }
  }
  if (std::ranges::find(used, std::uint8_t{0}) != used.end()) return false;
  return body.others().empty() &&
         std::ranges::all_of(body.forms().new_nodes(), [&](const NewNode& n) {
           for (int axis = 0; axis < 3; ++axis) {
             if (!n.axes.has(axis) && problem.dof(n.parent, axis) != kNone) return false;
           }
           return !(n.tie > 0);
         });
}

PartedBody::PartedBody(const DamagedBody& body)
    : whole_(body.problem()), body_(parted_problem(body)) {
  for (const NewNode& node : body.forms().new_nodes()) add(node, kNone);
  std::vector<Index> gone;
  for (Index e = 0; e < whole_.tet_count(); ++e) {
    if (body.destroyed()[static_cast<std::size_t>(e)]) gone.push_back(e);
  }
  body_.destroy(gone);
  const auto own = body.forms().own_gripped();
  const auto since = body.forms().gripped().subspan(own.size());
  std::vector<Index> let_go;
  const auto all = whole_.gripped_dofs();
  std::set_difference(all.begin(), all.end(), own.begin(), own.end(), std::back_inserter(let_go));
  if (!let_go.empty()) body_.grip({}, let_go);
  if (!since.empty()) body_.grip(since, {});
}

void PartedBody::add(const NewNode& node, Index by) {
  kept_.push_back({node.parent, by, node.axes});
}

const std::array<Index, 4>& PartedBody::corners(Index element) const {
  const auto changed = corners_.find(element);
  return changed == corners_.end() ? body_.problem().mesh().tets[static_cast<std::size_t>(element)]
                                   : changed->second;
}

/// A node that comes has parted from the corner that its elements had until then.
Change PartedBody::translate(const Event& event) {
  Change told;
  told.leave.assign(event.leave.begin(), event.leave.end());
  told.come.assign(event.come.begin(), event.come.end());
  told.ties.assign(event.ties.begin(), event.ties.end());
  told.held = event.held;
  told.grasp.assign(event.grasp.begin(), event.grasp.end());
  told.release.assign(event.release.begin(), event.release.end());
  const Index first = whole_.node_count() + static_cast<Index>(kept_.size());
  for (std::size_t i = 0; i < event.nodes.size(); ++i) {
    const Index node = first + static_cast<Index>(i);
    Index from = event.nodes[i].parent;
    for (const Coming& c : event.come) {
      const auto at = std::ranges::find(c.form.corners, node) - c.form.corners.begin();
      if (at == 4) continue;
      from = corners(c.element)[static_cast<std::size_t>(at)];
      break;
    }
    // One that came since is an offset here as well, of a node that was there.
    const Index there = body_.problem().node_count();
    if (from >= there) from = kept_[static_cast<std::size_t>(from - whole_.node_count())].by;
    add(event.nodes[i], from);
    told.nodes.push_back({from, event.nodes[i].axes, event.nodes[i].tie});
  }
  for (const Coming& c : event.come) corners_[c.element] = c.form.corners;
  return told;
}

/// act(place of the offset, unknown of the node that it is measured by in the body, that here or
/// kNone).
template <class Act>
void PartedBody::for_unknowns(Act&& act) const {
  Eigen::Index place = whole_.dof_count();
  for (const Kept& node : kept_) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!node.axes.has(axis)) continue;
      const Index here = node.by == kNone ? kNone : body_.problem().dof(node.by, axis);
      act(place++, whole_.dof(node.of, axis), here);
    }
  }
}

void PartedBody::take_forces(Eigen::VectorXd& forces) const {
  for_unknowns([&](Eigen::Index place, Index of, Index here) {
    forces[of] -= forces[place];
    if (here != kNone) forces[here] += forces[place];
  });
}

void PartedBody::give_displacement(Eigen::VectorXd& u) const {
  const Eigen::VectorXd own = u;
  for_unknowns([&](Eigen::Index place, Index of, Index here) {
    u[place] = own[place] - own[of] + (here == kNone ? 0.0 : own[here]);
  });
}

}  // namespace sunder::fem
