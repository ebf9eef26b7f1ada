// SPDX-License-Identifier: Apache-2.0
#include "gpu/host_update.hpp"

namespace sunder::gpu {
namespace {

// So many columns of the damage begin a new base, which replaces the old one so many events later:
// a frame reads all exact columns, and the inverse of the board takes a thread some 50 frames.
constexpr Index kColumnsPerBase = 256;
constexpr int kEventsUntilNext = 24;

engine::Based based_on(const Problem& problem, std::shared_ptr<const HostInverse> inverse,
                       bool damage) {
  engine::Based based;
  based.factor = {inverse, &inverse->factor()};
  based.deferred = std::make_unique<engine::Deferred>(
      problem, std::make_unique<HostBase>(std::move(inverse)), damage, kColumnsPerBase);
  return based;
}

}  // namespace

std::unique_ptr<engine::Deferred> intact_update(const Problem& problem,
                                                std::shared_ptr<const HostInverse> intact) {
  return std::move(based_on(problem, std::move(intact), false).deferred);
}

std::unique_ptr<engine::RenewedUpdate> host_update(const engine::DamagedBody& body,
                                                   std::shared_ptr<const HostInverse> intact,
                                                   bool damage) {
  const bool dense = intact->is_dense();
  engine::Based first = based_on(body.problem(), std::move(intact), damage);
  if (!damage) return std::make_unique<engine::RenewedUpdate>(body, std::move(first));
  engine::Renewal renewal;
  if (dense) {
    renewal.columns = body.problem().gripped_dofs().size() + kColumnsPerBase;
    renewal.first_columns = renewal.columns;
    renewal.events = kEventsUntilNext;
  }
  return std::make_unique<engine::RenewedUpdate>(
      body, std::move(first), renewal,
      [dense](const engine::DamagedBody& of, const fem::FactorWork& work) {
        return based_on(of.problem(),
                        std::make_shared<const HostInverse>(of.problem(), of.scale(), dense, work),
                        true);
      });
}

}  // namespace sunder::gpu
