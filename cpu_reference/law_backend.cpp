// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/law_backend.hpp"

#include <algorithm>

#include "body/analysis.hpp"
#include "cpu_reference/available_memory.hpp"
#include "cpu_reference/stress.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::cpu_reference {

LawBackend::LawBackend(std::shared_ptr<const Problem> shared, Needs needs)
    : Backend(shared, std::move(needs)),
      u_(shared->dofs().size(), 0.0),
      laws_(fem::laws_of(*shared)),
      body_{*shared, laws_, destroyed()},
      intact_{*shared, laws_},
      pass_(body_) {
  const std::size_t elements = shared->mesh().tets.size();
  if (this->needs().stress) stress_.assign(elements, Voigt::Zero());
  if (this->needs().yield) excluded_.assign(elements, 0);
}

std::vector<BufferPlan> LawBackend::field_buffers() const {
  std::vector<BufferPlan> plan{{"displacement and forces", u_.size() * 4 * sizeof(double)}};
  if (by_inverse(problem())) plan.push_back({"dense inverse of it", inverse_bytes(problem())});
  if (needs().stress) plan.push_back({"stress", stress_.size() * sizeof(Voigt)});
  return plan;
}

std::vector<KernelPlan> LawBackend::field_kernels() const {
  const auto elements = std::to_string(problem().tet_count());
  std::vector<KernelPlan> list{
      {"internal forces", "energy and forces of " + elements + " elements by their laws"},
      {"line search", "on the energy, a pass over the elements for each length that it tries"},
      {"check", "one base application to what is left, and the stress that it would change"}};
  if (needs().damage) {
    list.push_back({"small update", "of the base by the tangents of destroyed elements"});
  }
  if (needs().stress) {
    list.push_back({"stress", elements + " elements, the stress that fracture.stress names"});
  }
  if (needs().yield) list.push_back({"yield summary", "largest ratio, and where"});
  return list;
}

std::shared_ptr<InstrumentForces> LawBackend::instrument_forces() {
  if (problem().gripped_dofs().empty()) return nullptr;
  if (!instruments_) {
    instruments_.emplace(problem());
    reactions_.assign(problem().gripped_dofs().size(), 0.0);
    publish_instruments();
  }
  return instruments_->forces();
}

void LawBackend::take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) {
  if (instrument_forces()) instruments_->take_over(std::move(forces));
}

void LawBackend::publish_instruments() {
  if (!instruments_ || load_.displacements.size() != reactions_.size()) return;
  const Eigen::MatrixXd l = grip_compliance();
  if (l.size() == 0) return;
  read_reactions(reactions_);
  instruments_->publish(l, reactions_, load_.displacements);
}

StressSummary LawBackend::do_stress() {
  fem::HyperelasticPass::Wanted wanted;
  wanted.stress = stress_;
  wanted.measure = problem().scene().fracture.stress;
  pass_.run(u_, wanted);
  const auto none = without_stress();
  for (Index e = 0; e < problem().tet_count(); ++e) {
    if (none[e]) stress_[e].setZero();
  }
  return needs().yield ? summarize(problem(), destroyed(), excluded_, stress_) : StressSummary{};
}

Deformation LawBackend::do_deformation() {
  fem::HyperelasticPass::Wanted wanted;
  wanted.deformation = true;
  return pass_.run(u_, wanted).deformation;
}

void LawBackend::do_destroy(std::span<const Index> elements) {
  pass_.destroy(elements);
  if (!needs().stress) return;
  for (Index e : elements) stress_[e].setZero();
}

void LawBackend::do_exclude_candidates(std::span<const Index> elements) {
  for (Index e : elements) excluded_[e] = 1;
}

void LawBackend::do_read_displacement(std::span<double> displacement) const {
  std::ranges::copy(u_, displacement.begin());
}

void LawBackend::do_read_displacement(std::span<const Index> nodes,
                                      std::span<Vec3> displacement) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) displacement[i] = Vec3(&u_[3 * nodes[i]]);
}

void LawBackend::do_read_stress(std::span<Voigt> stress) const {
  std::ranges::copy(stress_, stress.begin());
}

bool by_inverse(const Problem& problem) { return problem.scene().solver.route == Route::inverse; }

std::size_t inverse_bytes(const Problem& problem) {
  const auto unknowns = static_cast<std::size_t>(problem.dof_count());
  return by_inverse(problem) ? unknowns * unknowns * sizeof(double) : 0;
}

std::size_t check_law_options(const Problem& problem, const CpuOptions& options,
                              std::size_t bases) {
  const SolverOptions& solver = problem.scene().solver;
  const std::string whom = problem.moves() ? "motion" : "law " + in_quotes(problem.law());
  const auto refuse = [&](const std::string& what, const std::string& why,
                          const std::string& instead) {
    throw DeviceError(what + " cannot serve " + whom + ": " + why + "; use " + instead);
  };
  if (solver.precision == Precision::fp32) {
    refuse("precision fp32", "backend cpu computes in fp64 only", "precision fp64 or auto");
  }
  if (solver.route == Route::cg) {
    refuse("route cg", "its preconditioner is the factor of the intact body at rest",
           "route factor or auto");
  }
  if (solver.route == Route::condensed) {
    refuse("route condensed", "the stiffness outside its region changes with the deformation",
           "route factor or auto");
  }
  if (solver.update == Update::eager) {
    refuse("update eager", "the base is a tangent that later states do not write over",
           "update deferred or auto");
  }
  const std::size_t free = options.memory > 0 ? options.memory : available_memory();
  const auto analysis = fem::analyse(problem);
  const std::size_t needed =
      bases * (analysis->entries() * sizeof(double) + inverse_bytes(problem));
  if (needed > free) {
    throw InputError(InputFault::too_large,
                     "the bases of a tangent need " + std::to_string(needed) + " bytes for " +
                         count_of(problem.dof_count(), "unknown") + ", but " +
                         std::to_string(free) + " are free; use a coarser mesh" +
                         (problem.moves() ? "" : " or law \"linear\""));
  }
  return analysis->entries();
}

}  // namespace sunder::cpu_reference
