// SPDX-License-Identifier: Apache-2.0
#include "finite/law_backend.hpp"

#include <algorithm>
#include <cstdio>

#include "body/analysis.hpp"
#include "body/damaged_body.hpp"
#include "body/parted_body.hpp"
#include "body/parting.hpp"
#include "body/stress_summary.hpp"
#include "finite/motion_backend.hpp"
#include "finite/statics_backend.hpp"
#include "solver/finite_motion.hpp"
#include "solver/finite_statics.hpp"
#include "solver/grip_stiffness.hpp"
#include "solver/plan.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::finite {
namespace {

/// Of L-BFGS.
int pairs_of(const Problem& problem) {
  return problem.moves() ? solver::FiniteMotionOptions{}.pairs
                         : solver::FiniteStaticsOptions{}.pairs;
}

}  // namespace

LawBackend::LawBackend(std::shared_ptr<const Problem> shared, Needs needs, Machine machine)
    : Backend(shared, std::move(needs)),
      u_(shared->dofs().size(), 0.0),
      laws_(fem::laws_of(*shared)),
      intact_{*shared, laws_},
      machine_(std::move(machine)),
      route_(chosen_route()),
      factor_entries_(check_options()),
      now_(computed_as(shared)) {
  const std::size_t elements = shared->mesh().tets.size();
  if (this->needs().stress) stress_.assign(elements, Voigt::Zero());
  if (this->needs().yield) excluded_.assign(elements, 0);
  if (route_ == Route::cg) {
    leave_out("forces of grips between frames: route cg has no base to find them by");
  }
  if (machine_.device && this->needs().pristine) {
    device_of_intact_ = machine_.device(intact_, route_, pairs_of(*shared));
  }
}

LawBackend::Computed LawBackend::computed_as(std::shared_ptr<const Problem> problem) {
  Computed as;
  as.problem = std::move(problem);
  as.body = std::make_unique<const fem::HyperelasticBody>(
      fem::HyperelasticBody{*as.problem, laws_, destroyed()});
  as.pass = std::make_unique<fem::HyperelasticPass>(*as.body);
  if (machine_.device && lost_.empty()) {
    as.device = machine_.device(*as.body, route_, pairs_of(*as.problem));
  }
  return as;
}

LawBackend::Computed LawBackend::compute_as(const std::shared_ptr<const Problem>& problem) {
  Computed next;
  try {
    next = computed_as(problem);
  } catch (const DeviceLost& error) {
    if (!now_.device) throw;
    lost_ = error.what();
    next = computed_as(problem);
  }
  next.pass->cut_off(cut_off_);
  return next;
}

/// With the nodes that have parted and all that is gripped now.
std::shared_ptr<const Problem> LawBackend::body_now() const {
  const auto gripped = std::make_shared<const Problem>(problem(), gripped_dofs());
  if (damaged_body().forms().new_nodes().empty()) return gripped;
  return fem::parted_problem(damaged_body(), *gripped);
}

LawBackend::Computed LawBackend::part() {
  const auto parted = body_now();
  leave_inverse_if_outgrown(*parted);
  Computed next = compute_as(parted);
  const fem::Parting parting(computed(), *parted);
  parting.nodal(u_);
  fem::add_parted_grips(*parted, load_.displacements);
  deformation_.reset();
  std::swap(now_, next);
  return next;
}

/// Nodes that have parted bring unknowns; a factor has room for them where an inverse has none.
void LawBackend::leave_inverse_if_outgrown(const Problem& next) {
  if (!now_.device || !by_inverse() || next.dof_count() <= machine_.largest_dense) return;
  route_ = Route::factor;
  outgrown_ = true;
}

std::string LawBackend::why_no_grasp() const {
  if (!needs().pristine) return {};
  return "the intact body's field, which the fracture model reads, is held by the scene's grips "
         "alone "
         "where tangents are the body's own; take law \"linear\" in statics on backend cpu, or "
         "model "
         "\"A\"";
}

LawBackend::Computed LawBackend::take_grips(std::span<const Index> before) {
  Computed next = compute_as(body_now());
  // What is new is held where it is.
  std::vector<double> at(static_cast<std::size_t>(next.problem->dof_count()), 0.0);
  for (std::size_t i = 0; i < next.problem->dofs().size(); ++i) {
    const Index d = next.problem->dofs()[i];
    if (d != kNone) at[static_cast<std::size_t>(d)] = u_[i];
  }
  const auto was = computed().gripped_dofs();
  for (std::size_t g = 0; g < std::min(was.size(), load_.displacements.size()); ++g) {
    const bool parted = was[g] >= problem().dof_count();  // with a node that was held before
    if (parted || std::ranges::find(before, was[g]) != before.end()) {
      at[static_cast<std::size_t>(was[g])] = load_.displacements[g];
    }
  }
  load_.displacements.clear();
  for (Index d : next.problem->gripped_dofs()) {
    load_.displacements.push_back(at[static_cast<std::size_t>(d)]);
  }
  std::swap(now_, next);
  return next;
}

/// A body computed by itself has its gripped unknowns in ascending order.
void LawBackend::do_set_load(const Load& load) {
  load_ = load;
  if (!std::ranges::equal(gripped_dofs(), problem().gripped_dofs())) {
    const auto sorted = computed().gripped_dofs();
    for (std::size_t g = 0; g < load.displacements.size(); ++g) {
      const auto place = std::ranges::lower_bound(sorted, gripped_dofs()[g]) - sorted.begin();
      load_.displacements[static_cast<std::size_t>(place)] = load.displacements[g];
    }
  }
  fem::add_parted_grips(computed(), load_.displacements);
}

void LawBackend::sum_grips(const Eigen::VectorXd& forces, std::span<double> reactions) const {
  const auto gripped = computed().gripped_dofs();
  const auto parted = computed().parted_grips();
  for (std::size_t g = 0; g < reactions.size(); ++g) reactions[g] = forces[gripped_dofs()[g]];
  for (std::size_t i = 0; i < parted.size(); ++i) {
    // `parted` counts them in the order of the unknowns.
    const Index of = gripped[static_cast<std::size_t>(parted[i])];
    const auto g = std::ranges::find(gripped_dofs(), of) - gripped_dofs().begin();
    reactions[static_cast<std::size_t>(g)] += forces[gripped[reactions.size() + i]];
  }
}

BackendInfo LawBackend::info() const {
  BackendInfo info = machine_.info;
  info.route = solver::name_of(route_);
  info.update = needs().damage ? "deferred" : "none";
  const Words say = words();
  if (route_ == Route::cg) {
    info.why = say.what + ": by conjugate gradients on the tangent of every state" +
               (now_.device ? ", on the device with forces, stress and line search" : "");
  } else {
    info.why = say.what + ": by the " + (by_inverse() ? "dense inverse" : "factor") + " of " +
               say.tangent +
               (!now_.device   ? ""
                : by_inverse() ? ", made by the host; forces, stress and L-BFGS on the device"
                               : ", by the host; forces and stress on the device");
  }
  if (outgrown_) {
    info.why += "; the inverse for " + count_of(computed().dof_count(), "unknown") +
                " of the parted body is larger than a buffer of the device, which holds that for " +
                std::to_string(machine_.largest_dense);
  }
  if (by_inverse() && &computed() != &problem()) {
    info.why +=
        "; where nodes part, by the host's factor until an inverse is made anew beside the steps";
  }
  if (!lost_.empty()) info.why += "; the host took over from the device: " + lost_;
  info.quiet_ms = now_.device ? 0 : cost_.quiet_ms;
  if (needs().damage && !now_.device) info.fracture_ms = cost_.torn_ms;
  for (const BufferPlan& b : buffers()) info.memory_bytes += b.bytes;
  return info;
}

std::vector<std::string> LawBackend::warnings() const {
  if (lost_.empty()) return {};
  return {"backend vulkan failed in mid-run, cpu took over from the last frame: " + lost_ +
          "; look for a driver's reset in the system log, or use backend cpu"};
}

std::vector<BufferPlan> LawBackend::buffers() const {
  const std::size_t factor = factor_entries_ * sizeof(double),
                    unknowns = static_cast<std::size_t>(problem().dof_count()),
                    dense = by_inverse() ? unknowns * unknowns * sizeof(double) : 0;
  std::vector<BufferPlan> plan{{"displacement and forces", u_.size() * 4 * sizeof(double)}};
  if (route_ != Route::cg) {
    plan.push_back({"factor of " + words().tangent + " (sparse Cholesky)", factor});
  }
  if (by_inverse()) plan.push_back({"dense inverse of it", dense});
  if (needs().stress) plan.push_back({"stress", stress_.size() * sizeof(Voigt)});
  if (needs().pristine && route_ != Route::cg) {
    plan.push_back({"factor of the intact body's tangent", factor + dense});
  }
  for (const auto* device : {now_.device.get(), device_of_intact_.get()}) {
    if (!device) continue;
    for (BufferPlan& buffer : device->buffers()) {
      if (device != now_.device.get()) buffer.name += ", of the intact body";
      plan.push_back(std::move(buffer));
    }
  }
  return plan;
}

std::vector<KernelPlan> LawBackend::kernels() const {
  if (now_.device) return now_.device->kernels();
  const auto elements = std::to_string(problem().tet_count());
  const Words say = words();
  const auto about = [](double ms) {
    char text[32] = "";
    if (ms > 0) std::snprintf(text, sizeof text, ", about %.2g ms", ms);
    return std::string(text);
  };
  std::vector<KernelPlan> list{
      {"internal forces",
       "energy and forces of " + elements + " elements by their laws" + about(cost_.forces_ms)},
      {"base", (by_inverse() ? "product with the dense inverse of " + say.tangent
                             : "forward and backward through the factor of " + say.tangent + ", " +
                                   std::to_string(factor_entries_) + " values") +
                   about(cost_.back_solve_ms) + say.iteration},
      {"new base",
       say.tangent + " assembled and factored beside the steps" + about(cost_.tangent_ms)},
      {"line search", "on the energy, a pass over the elements for each length that it tries"},
      {"check", "one base application to what is left, and the stress that it would change"}};
  if (needs().damage) {
    list.push_back({"small update", "of the base by the tangents of destroyed elements"});
  }
  if (needs().stress) {
    list.push_back({"stress", elements + " elements, the stress that fracture.stress names" +
                                  about(cost_.stress_ms)});
  }
  if (needs().yield) list.push_back({"yield summary", "largest ratio, and where"});
  return list;
}

std::shared_ptr<InstrumentForces> LawBackend::instrument_forces() {
  if (route_ == Route::cg || !has_grips()) return nullptr;
  if (!instruments_) {
    instruments_.emplace(problem());
    publish_instruments();
  }
  return instruments_->forces();
}

void LawBackend::take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) {
  if (instrument_forces()) instruments_->take_over(std::move(forces));
}

void LawBackend::publish_instruments() {
  const auto computed_grips = computed().gripped_dofs();
  if (!instruments_ || load_.displacements.size() < computed_grips.size()) return;
  if (gripped_dofs().empty()) {  // but some may be grasped
    instruments_->publish({}, Eigen::MatrixXd(0, 0), {}, {});
    return;
  }
  const Eigen::MatrixXd stiffness = grip_stiffness();
  if (stiffness.rows() < static_cast<Eigen::Index>(gripped_dofs().size())) return;  // unknown
  std::vector<Eigen::Index> places;  // of gripped_dofs() in the computed body's, in order of dofs
  held_.clear();
  for (Index d : gripped_dofs()) {
    places.push_back(std::ranges::lower_bound(computed_grips, d) - computed_grips.begin());
    held_.push_back(load_.displacements[static_cast<std::size_t>(places.back())]);
  }
  reactions_.resize(gripped_dofs().size());
  read_reactions(reactions_);
  instruments_->publish(
      gripped_dofs(),
      solver::compliance_factor(stiffness(places, places), instruments_->anchors(gripped_dofs())),
      reactions_, held_);
}

StressSummary LawBackend::do_stress() {
  attempt([&] {
    if (stress_known_) return;  // nothing has moved
    if (problem().pools()) {
      now_.pass->leave_alone(without_stress());
      now_.pass->split_pools(resting().body().split);
    }
    if (now_.device) {
      now_.device->stress(u_, stress_);
      return;
    }
    fem::HyperelasticPass::Wanted wanted;
    wanted.stress = stress_;
    wanted.measure = problem().scene().fracture.stress;
    now_.pass->run(u_, wanted);
  });
  const auto none = without_stress();
  for (std::size_t e = 0; e < stress_.size(); ++e) {
    if (none[e]) stress_[e].setZero();
    if (!stress_[e].allFinite()) {
      throw NumericalError("the stress of element " + std::to_string(e) +
                           " is beyond what double precision holds; take a smaller load");
    }
  }
  stress_known_ = true;
  return needs().yield ? fem::summarize(problem(), destroyed(), excluded_, stress_)
                       : StressSummary{};
}

Deformation LawBackend::do_deformation() {
  if (!deformation_) {
    fem::HyperelasticPass::Wanted wanted;
    wanted.deformation = true;
    deformation_ = now_.pass->run(u_, wanted).deformation;
  }
  return *deformation_;
}

void LawBackend::moved_to(const std::vector<double>& u) {
  u_ = u;
  stress_known_ = false;
  deformation_.reset();
}

void LawBackend::do_destroy(std::span<const Index> elements) {
  now_.pass->destroy(elements);
  deformation_.reset();
  if (!needs().stress) return;
  for (Index e : elements) stress_[e].setZero();
}

void LawBackend::do_exclude_candidates(std::span<const Index> elements) {
  for (Index e : elements) excluded_[e] = 1;
}

void LawBackend::do_read_displacement(std::span<double> displacement) const {
  std::copy_n(u_.begin(), displacement.size(), displacement.begin());
}

void LawBackend::do_read_displacement(std::span<const Index> nodes,
                                      std::span<Vec3> displacement) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) displacement[i] = Vec3(&u_[3 * nodes[i]]);
}

void LawBackend::do_read_stress(std::span<Voigt> stress) const {
  std::ranges::copy(stress_, stress.begin());
}

/// As the scene says; else on the host a factor, on a device an inverse of bodies that are small
/// enough, and of others in motion none at all.
Route LawBackend::chosen_route() const {
  const Route asked = problem().scene().solver.route;
  if (asked != Route::automatic) return asked;
  if (!machine_.device) return Route::factor;
  if (problem().dof_count() <= machine_.most_dense) return Route::inverse;
  return problem().moves() && !problem().pools() ? Route::cg : Route::factor;
}

/// Returns the entries of a factor, where there is one; the host's cost is known then.
std::size_t LawBackend::check_options() {
  const SolverOptions& solver = problem().scene().solver;
  const bool moves = problem().moves(), on_device = static_cast<bool>(machine_.device);
  const std::string whom =
      moves ? "motion"
            : "law " + in_quotes(problem().law()) + (problem().fibrous() ? " with fibres" : "");
  const auto refuse = [&](const std::string& what, const std::string& why,
                          const std::string& instead) {
    throw DeviceError(what + " cannot serve " + whom + ": " + why + "; use " + instead);
  };
  if (needs().contact) {
    refuse("fracture.contact = true",
           "what keeps lips apart belongs to the small matrix of one base",
           "law \"linear\" in statics on backend cpu, or contact false");
  }
  if (solver.precision == Precision::fp32 && !on_device) {
    refuse("precision fp32", "backend cpu computes in fp64 only", "precision fp64 or auto");
  }
  if (solver.route == Route::cg && !on_device) {
    refuse("route cg", "its preconditioner is the factor of the intact body at rest",
           "route factor or auto");
  }
  if (solver.route == Route::cg && !moves) {
    refuse("route cg", "whether a rest is stable is judged by a factor of its tangent",
           "route inverse, factor or auto");
  }
  if (solver.route == Route::cg && problem().pools()) {
    refuse("route cg", "it knows the tangents of elements, not those of patches of pooled volume",
           "route inverse, factor or auto");
  }
  if (solver.route == Route::condensed) {
    refuse("route condensed", "the stiffness outside its region changes with the deformation",
           on_device && moves ? "route inverse, factor, cg or auto"
           : on_device        ? "route inverse, factor or auto"
                              : "route factor or auto");
  }
  if (solver.update == Update::eager) {
    refuse("update eager", "the base is a tangent that later states do not write over",
           "update deferred or auto");
  }
  if (route_ == Route::cg) return 0;
  // The factor and that of a newer base beside it, and the intact body's.
  const std::size_t bases = needs().pristine ? 4 : 2;
  const auto unknowns = static_cast<std::size_t>(problem().dof_count());
  const auto analysis = fem::analyse(problem());
  const std::size_t needed =
      bases * (analysis->entries() + (by_inverse() ? unknowns * unknowns : 0)) * sizeof(double);
  if (needed > machine_.memory) {
    throw InputError(InputFault::too_large,
                     "the bases of a tangent need " + std::to_string(needed) + " bytes for " +
                         count_of(problem().dof_count(), "unknown") + ", but " +
                         std::to_string(machine_.memory) + " are free; use a coarser mesh" +
                         (moves ? "" : " or law \"linear\""));
  }
  if (!on_device) {
    cost_ = solver::law_cost(*analysis->nodes, problem(), by_inverse() ? unknowns : 0);
  }
  return analysis->entries();
}

std::unique_ptr<Backend> create(std::shared_ptr<const Problem> problem, Needs needs,
                                Machine machine) {
  const bool moves = problem->moves();
  return moves ? create_motion(std::move(problem), std::move(needs), std::move(machine))
               : create_statics(std::move(problem), std::move(needs), std::move(machine));
}

}  // namespace sunder::finite
