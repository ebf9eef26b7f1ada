// SPDX-License-Identifier: Apache-2.0
// The deferred update of a device: its base and its small matrices are the host's (beside
// passes/damage_solution.hpp), the product with the base's columns is the device's.
#pragma once

#include <memory>

#include "gpu/host_base.hpp"
#include "solver/renewed_update.hpp"

namespace sunder::gpu {

/// Loads of up to so many unknowns get exact columns; a larger one is multiplied by the inverse in
/// storage precision.
inline constexpr std::size_t kExactLoads = 64;

/// Over the intact body's inverse, without damage.
[[nodiscard]] std::shared_ptr<solver::Deferred> intact_update(
    const Problem& problem, std::shared_ptr<const HostInverse> intact);

/// The same for a body that can be damaged; a dense inverse is made anew beside the frames. `fp64`:
/// what is promised, for which columns may have to be refined. `device`: the first base's inverse,
/// to read its columns there. `renews`: that gets a new base's as well, so that a factor is made
/// anew beside the frames (renewal_of()).
[[nodiscard]] std::unique_ptr<solver::RenewedUpdate> host_update(
    const fem::DamagedBody& body, std::shared_ptr<const HostInverse> intact, bool damage, bool fp64,
    const DenseInverse* device = nullptr, bool renews = false);

/// When that makes a base anew.
[[nodiscard]] solver::Renewal renewal_of(const Problem& problem, const HostInverse& intact,
                                         bool renews);
/// Columns that come from the beginning of such a base to the event that has it in place.
[[nodiscard]] Index columns_between(const solver::Renewal& renewal);
/// Columns of the damage that a base of such an update is expected to come to.
[[nodiscard]] Index columns_of_a_base(const solver::Renewal& renewal);

/// The base that such an update has at present.
[[nodiscard]] inline const HostBase& base_of(const solver::RenewedUpdate& update) {
  return static_cast<const HostBase&>(update.deferred().base());
}
[[nodiscard]] inline HostBase& base_of(solver::RenewedUpdate& update) {
  return static_cast<HostBase&>(update.deferred().base());
}

}  // namespace sunder::gpu
