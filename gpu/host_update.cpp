// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_update.hpp"

#include <algorithm>

#include "body/body_factors.hpp"
#include "solver/frame_cost.hpp"

namespace sunder::gpu {
namespace {

// So many columns of the damage begin a new base, which replaces the old one so many events later:
// a frame reads all exact columns, and the inverse of the board takes a thread some 50 frames.
constexpr Index kColumnsPerBase = 256;
constexpr int kEventsUntilNext = 24;

// Columns of a usual event of one element, and seconds that one takes.
constexpr Index kColumnsOfAnEvent = 3;
constexpr double kEvent = 5e-4;
// Where a device makes the next base's inverse (passes/inverse_update.hpp) with each event it does
// so many flops, a tenth of a millisecond of three Tflop/s, and more where that would take more
// than so many events: their columns would cost the host more than they spare the device. Nor does
// a thread get more of them for its factor.
constexpr double kFlopsOfAnEvent = 3e8, kMostEvents = 128;
// Events that a base lacks once it is made: each further one follows so many.
constexpr int kEventsAtOnce = 4;

solver::Based based_on(const fem::Forms& in_base, std::shared_ptr<const HostInverse> inverse,
                       bool damage, const fem::DamagedBody* body = nullptr,
                       const DenseInverse* device = nullptr, Index columns = kColumnsPerBase) {
  solver::Based based;
  based.factor = {inverse, &inverse->factor()};
  based.deferred = std::make_unique<solver::Deferred>(
      in_base, std::make_unique<HostBase>(std::move(inverse), body, device, columns), damage,
      columns);
  return based;
}

}  // namespace

std::shared_ptr<solver::Deferred> intact_update(const Problem& problem,
                                                std::shared_ptr<const HostInverse> intact) {
  return std::move(based_on(fem::Forms(problem), std::move(intact), false).deferred);
}

solver::Renewal renewal_of(const Problem& problem, const HostInverse& intact, bool renews) {
  solver::Renewal renewal;
  if (!intact.is_dense() && !renews) return renewal;
  renewal.columns = problem.gripped_dofs().size() + kColumnsPerBase;
  renewal.first_columns = renewal.columns;
  renewal.events = kEventsUntilNext;
  if (intact.is_dense()) return renewal;
  const double n = problem.dof_count(), k = static_cast<double>(renewal.columns);
  const double of_inverse = (12 * k * k * n + k * n * n) / kFlopsOfAnEvent;
  const int of_factor = solver::frames_of_a_factor(
      intact.factor().cholesky(), static_cast<std::size_t>(problem.tet_count()), kEvent);
  renewal.events = static_cast<int>(std::min(std::max<double>(of_factor, of_inverse), kMostEvents));
  renewal.events_at_once = kEventsAtOnce;
  return renewal;
}

Index columns_between(const solver::Renewal& renewal) {
  const int lacking = renewal.events / std::max(renewal.events_at_once - 1, 1);
  return kColumnsOfAnEvent * static_cast<Index>(renewal.events + lacking);
}

Index columns_of_a_base(const solver::Renewal& renewal) {
  if (renewal.columns == solver::Renewal::kNever) return solver::Deferred::kReserved;
  const Index between = columns_between(renewal);
  return std::max(kColumnsPerBase, between) + between;
}

std::unique_ptr<solver::RenewedUpdate> host_update(const fem::DamagedBody& body,
                                                   std::shared_ptr<const HostInverse> intact,
                                                   bool damage, bool fp64,
                                                   const DenseInverse* device, bool renews) {
  const bool dense = intact->is_dense();
  const solver::Renewal renewal = renewal_of(body.problem(), *intact, renews);
  const bool beside = renews && !dense;
  const Index columns = beside ? columns_of_a_base(renewal) : kColumnsPerBase;
  const auto factors = std::make_shared<fem::BodyFactors>(
      body.problem(), intact->factor().cholesky().shared_supernodes());
  const fem::DamagedBody before = body.as_of(0);
  solver::Based first = based_on(before.forms(), std::move(intact), damage,
                                 fp64 ? &before : nullptr, device, columns);
  if (!damage) return std::make_unique<solver::RenewedUpdate>(body, std::move(first));
  static_cast<HostBase&>(first.deferred->base()).count_in(factors);
  return std::make_unique<solver::RenewedUpdate>(
      body, std::move(first), renewal,
      [dense, fp64, beside, columns, factors](const fem::DamagedBody& of,
                                              const linear_algebra::FactorWork& work) {
        solver::Based based = based_on(
            of.forms(), std::make_shared<const HostInverse>(factors->of(of, work), dense, work),
            true, fp64 ? &of : nullptr, nullptr, columns);
        auto& base = static_cast<HostBase&>(based.deferred->base());
        if (beside) base.keep_columns();
        base.count_in(factors);
        return based;
      });
}

}  // namespace sunder::gpu
