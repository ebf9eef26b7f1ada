// SPDX-License-Identifier: Apache-2.0
// Which instrument an element's stress comes from. The body is linear: at fixed principal
// directions its maximum shear stress is a sum of one term per instrument. All terms come from a
// single adjoint solve (Betti's theorem), however many instruments act.
#pragma once

#include <vector>

#include "frame/loads.hpp"
#include "sunder/backend.hpp"

namespace sunder {

struct Attribution {
  int instrument = kNone;  ///< with the largest term, or a host's tool by id; kNone: nothing acts
  double share = 0;        ///< its term over the whole
  /// [MPa] per instrument, then per tool of a host; they sum up to the maximum shear stress.
  std::vector<double> terms;
};

/// Of a live element, under the load that `loads` holds and the backend has solved with stress.
/// Leaves the backend with another load and solution.
[[nodiscard]] Attribution attribution(Backend& backend, const Loads& loads, Index element);

}  // namespace sunder
