// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_update.hpp"

namespace sunder::gpu {
namespace {

// So many columns of the damage begin a new base, which replaces the old one so many events later:
// a frame reads all exact columns, and the inverse of the board takes a thread some 50 frames.
constexpr Index kColumnsPerBase = 256;
constexpr int kEventsUntilNext = 24;

solver::Based based_on(const fem::Forms& in_base, std::shared_ptr<const HostInverse> inverse,
                       bool damage, const fem::DamagedBody* body = nullptr,
                       const DenseInverse* device = nullptr) {
  solver::Based based;
  based.factor = {inverse, &inverse->factor()};
  based.deferred = std::make_unique<solver::Deferred>(
      in_base, std::make_unique<HostBase>(std::move(inverse), body, device), damage,
      kColumnsPerBase);
  return based;
}

}  // namespace

std::shared_ptr<solver::Deferred> intact_update(const Problem& problem,
                                                std::shared_ptr<const HostInverse> intact) {
  return std::move(based_on(fem::Forms(problem), std::move(intact), false).deferred);
}

std::unique_ptr<solver::RenewedUpdate> host_update(const fem::DamagedBody& body,
                                                   std::shared_ptr<const HostInverse> intact,
                                                   bool damage, bool fp64,
                                                   const DenseInverse* device) {
  const bool dense = intact->is_dense();
  const fem::DamagedBody before = body.as_of(0);
  solver::Based first =
      based_on(before.forms(), std::move(intact), damage, fp64 ? &before : nullptr, device);
  if (!damage) return std::make_unique<solver::RenewedUpdate>(body, std::move(first));
  solver::Renewal renewal;
  if (dense) {
    renewal.columns = body.problem().gripped_dofs().size() + kColumnsPerBase;
    renewal.first_columns = renewal.columns;
    renewal.events = kEventsUntilNext;
  }
  return std::make_unique<solver::RenewedUpdate>(
      body, std::move(first), renewal,
      [dense, fp64](const fem::DamagedBody& of, const linear_algebra::FactorWork& work) {
        return based_on(of.forms(), std::make_shared<const HostInverse>(of, dense, work), true,
                        fp64 ? &of : nullptr);
      });
}

}  // namespace sunder::gpu
