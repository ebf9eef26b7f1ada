// SPDX-License-Identifier: Apache-2.0
#include "solver/condensed_fields.hpp"

#include <optional>

#include "body/assembly.hpp"
#include "body/element.hpp"

namespace sunder::solver {

CondensedFields::CondensedFields(const fem::DamagedBody& body, Region region)
    : body_(body), problem_(body.problem()), region_(std::move(region)) {
  for (Solution* s : {&displacement_, &of_stress_}) {  // so that frames allocate nothing
    s->of.reserve(region_.dofs.size(), region_.dofs.size());
  }
}

void CondensedFields::make_room(bool stress) {
  for (Solution* s : {&displacement_, &of_stress_}) s->nodal.reserve(problem_.dofs().size());
  room_.reserve(problem_.dof_count(), region_.dofs.size());
  u_.resize(problem_.dof_count());
  if (stress) stress_.reserve(problem_.mesh().tets.size());
}

void CondensedFields::take(const InverseRoute& route) {
  displacement_.everywhere = false;
  static_cast<void>(route.equilibrium(displacement_.of));
}

void CondensedFields::take(std::span<const double> nodal) {
  displacement_.nodal.assign(nodal.begin(), nodal.end());
  displacement_.everywhere = true;
}

void CondensedFields::publish_stress() {
  stress_known_ = false;
  events_ = body_.events();
  of_stress_.everywhere = displacement_.everywhere;
  if (displacement_.everywhere) {
    of_stress_.nodal = displacement_.nodal;
  } else {
    of_stress_.of = displacement_.of;
  }
}

void CondensedFields::solve(Solution& solution) {
  if (solution.everywhere) return;
  solve_whole(solution.of, room_, u_);
  solution.nodal.resize(problem_.dofs().size());
  fem::scatter(problem_, {u_.data(), static_cast<std::size_t>(u_.size())}, solution.nodal);
  solution.everywhere = true;
}

void CondensedFields::restore(const State& state) {
  displacement_ = state.displacement;
  of_stress_ = state.of_stress;
  events_ = state.events;
  stress_known_ = false;
}

void CondensedFields::complete(std::span<double> nodal) {
  if (!displacement_.everywhere && !displacement_.of.factor) return;  // nothing was solved yet
  solve(displacement_);
  for (std::size_t n = 0; n < region_.inside.size(); ++n) {
    if (region_.inside[n]) continue;
    for (std::size_t i = 3 * n; i < 3 * n + 3; ++i) nodal[i] = displacement_.nodal[i];
  }
}

std::span<const Voigt> CondensedFields::stress() {
  if (stress_known_) return stress_;
  solve(of_stress_);
  std::optional<fem::DamagedBody> published;
  if (events_ != body_.events()) published = body_.as_of(events_);
  const auto scale = published ? published->scale() : body_.scale();
  stress_.resize(scale.size());
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    stress_[e] = scale[e] * fem::stress_by_itself(problem_, e, of_stress_.nodal);
  }
  stress_known_ = true;
  return stress_;
}

std::size_t CondensedFields::bytes() const {
  return (displacement_.nodal.capacity() + of_stress_.nodal.capacity()) * sizeof(double) +
         room_.bytes() + static_cast<std::size_t>(u_.size()) * sizeof(double) +
         stress_.capacity() * sizeof(Voigt);
}

}  // namespace sunder::solver
