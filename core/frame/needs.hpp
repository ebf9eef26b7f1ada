// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sunder/backend.hpp"

namespace sunder {

/// Throws UsageError where a backend offers less than a scene needs.
void check_needs(const Needs& scene, const Needs& backend);

}  // namespace sunder
