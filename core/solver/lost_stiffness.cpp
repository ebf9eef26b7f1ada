// SPDX-License-Identifier: Apache-2.0
#include "solver/lost_stiffness.hpp"

#include <algorithm>

#include "body/stiffness_difference.hpp"

namespace sunder::solver {

LostStiffness::LostStiffness(const Problem& problem, std::span<const Index> elements) {
  elements_.reserve(elements.size());
  for (Index e : elements) {
    add(problem, problem.mesh().tets[e], fem::update_factor(problem, e), false);
  }
  number();
}

LostStiffness::LostStiffness(const fem::DamagedBody& body, std::size_t events) {
  const fem::DamagedBody before = body.as_of(events);
  const auto add_part = [&](const fem::StiffnessPart& part, bool came) {
    add(body.problem(), part.nodes, part.u, came);
  };
  for (Index e : body.changed(events, body.events())) {
    const fem::StiffnessDifference between = fem::difference(before.forms(), body.forms(), e);
    if (between.less) add_part(*between.less, false);
    if (between.more) add_part(*between.more, true);
  }
  number();
}

void LostStiffness::add(const Problem& problem, const std::array<Index, 4>& corners,
                        const fem::UpdateFactor& u, bool came) {
  Element& lost = elements_.emplace_back();
  lost.u = u;
  lost.came = came;
  for (std::size_t i = 0; i < 12; ++i) {
    lost.dofs[i] = problem.dof(corners[i / 3], static_cast<int>(i % 3));
    if (lost.dofs[i] != kNone) dofs_.push_back(lost.dofs[i]);
  }
}

void LostStiffness::number() {
  std::sort(dofs_.begin(), dofs_.end());
  dofs_.erase(std::unique(dofs_.begin(), dofs_.end()), dofs_.end());
  for (Element& lost : elements_) {
    for (Index& d : lost.dofs) {
      if (d == kNone) continue;
      d = static_cast<Index>(std::lower_bound(dofs_.begin(), dofs_.end(), d) - dofs_.begin());
    }
  }
}

void LostStiffness::multiply(std::span<const double> u, std::span<double> y) const {
  std::fill(y.begin(), y.end(), 0.0);
  Eigen::Matrix<double, 12, 1> corners;
  for (const Element& lost : elements_) {
    for (std::size_t i = 0; i < 12; ++i) {
      corners[static_cast<Eigen::Index>(i)] =
          lost.dofs[i] == kNone ? 0.0 : u[static_cast<std::size_t>(lost.dofs[i])];
    }
    // From the first corner: the columns of u^T add up to nothing on each axis.
    for (int i = 3; i < 12; ++i) corners[i] -= corners[i % 3];
    corners.head<3>().setZero();
    const Eigen::Matrix<double, 6, 1> strain = lost.u.transpose() * corners;
    corners.noalias() = lost.u * strain;
    if (lost.came) corners = -corners;
    for (std::size_t i = 0; i < 12; ++i) {
      if (lost.dofs[i] == kNone) continue;
      y[static_cast<std::size_t>(lost.dofs[i])] += corners[static_cast<Eigen::Index>(i)];
    }
  }
}

std::size_t LostStiffness::bytes() const {
  return elements_.size() * sizeof(Element) + dofs_.size() * sizeof(Index);
}

}  // namespace sunder::solver
