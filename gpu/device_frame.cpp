// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_frame.hpp"

#include <algorithm>
#include <cmath>

#include "body/assembly.hpp"

namespace sunder::gpu {
namespace {

// A full check refines silently down to this stress error, a fiftieth of what fp64 promises along a
// crack: at a ratio of .499 and 200 fractures displacement is off by fifteen times as much as
// stress (tests/gpu/extremes_test.cpp). Fp32 storage promises the scene's tolerance, half of which
// leaves room for the estimate's own error.
constexpr double kFp64Refined = 2e-10,
                 kFp32Refined = 5e-4;  // the latter however large the tolerance
// What fp64 promises of a damaged body; of an estimate half of it (cpu_reference/cpu_frame.cpp).
constexpr double kFp64Damaged = 1e-8, kFp64Estimated = 5e-9;

}  // namespace

void DeviceFrame::set_load(const Load& load) {
  load_ = load;
  force_squared_ = 0;
  for (double f : load.forces) force_squared_ += f * f;
}

solver::Precision DeviceFrame::precision() const {
  if (fp64_) return {kFp64Refined, kFp64Damaged, kFp64Estimated};
  const double tolerance = problem_.scene().solver.tolerance;
  return {std::min(kFp32Refined, tolerance / 2), tolerance, kFp32Refined};
}

int DeviceFrame::solve(double energy_tolerance, solver::Residual residual) {
  const bool reactions = !body_.forms().gripped().empty();
  first_ = true;
  if (residual == solver::Residual::whole && route_.corrects_on_host()) {
    read_along(first_by_elements_);  // most likely
  } else {
    fields_.read_along(ReadAlong::What::nothing);
  }
  return route_.solve(load_, energy_tolerance, residual != solver::Residual::none || reactions);
}

/// A correction begins with the residual, or with the displacement where that is summed by
/// elements.
void DeviceFrame::read_along(bool by_elements) {
  fields_.read_along(by_elements ? ReadAlong::What::displacement : ReadAlong::What::residual);
}

solver::Balance DeviceFrame::balance() const {
  const shaders::Summary s = fields_.state();
  return {std::sqrt(s.residual_squared), force_squared_ + s.reaction_squared, s.largest_u,
          fields_.largest_stress(Field::displacement)};
}

bool DeviceFrame::sum_by_elements(bool on) {
  by_elements_ = on && fp64_;
  return by_elements_;
}

/// f - K u, 0 at grips, on the host.
void DeviceFrame::sum_residual() {
  nodal_.resize(problem_.dofs().size());
  fields_.read_displacement(nodal_);
  u_.resize(problem_.dof_count());
  fem::gather(problem_, nodal_, {u_.data(), static_cast<std::size_t>(u_.size())});
  body_.apply(u_, r_);
  r_ = -r_;
  for (std::size_t i = 0; i < load_.forces.size(); ++i) r_[load_.force_dofs[i]] += load_.forces[i];
  for (Index d : body_.forms().gripped()) r_[d] = 0;
}

int DeviceFrame::correct_by_elements(bool add) {
  sum_residual();
  if (route_.correct_by_host(r_, add)) return 0;
  padded_.assign(fields_.rows(), 0.0);
  std::copy(r_.begin(), r_.end(), padded_.begin());
  fields_.write_residual(padded_);
  return route_.correct(add);
}

solver::FrameDevice::Correction DeviceFrame::correct(bool add) {
  Correction found;
  if (first_) first_by_elements_ = by_elements_;
  first_ = false;
  if (route_.corrects_on_host()) read_along(by_elements_);  // of a state that comes with it
  found.iterations = by_elements_ ? correct_by_elements(add) : route_.correct(add);
  found.stress = fields_.largest_stress(Field::correction);
  return found;
}

const solver::Deferred* DeviceFrame::deferred() const {
  const solver::RenewedUpdate* update = route_.update();
  return update ? &update->deferred() : nullptr;
}

int DeviceFrame::bases() const {
  const solver::RenewedUpdate* update = route_.update();
  return update ? update->bases() : 1;
}

const solver::BaseCheck& DeviceFrame::base_check() const {
  const solver::RenewedUpdate* update = route_.update();
  return update ? update->base_check() : FrameDevice::base_check();
}

}  // namespace sunder::gpu
