// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c/structs.hpp"
#include "sunder/backend.hpp"

namespace sunder::c {

/// What a backend says of itself, for the C interface.
[[nodiscard]] sunder_engine describe(const Problem& problem, const BackendInfo& info);

}  // namespace sunder::c
