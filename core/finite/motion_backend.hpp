// SPDX-License-Identifier: Apache-2.0
// The backend of bodies in motion, by any law.
#pragma once

#include "finite/law_backend.hpp"

namespace sunder::finite {

/// Throws as create() does.
[[nodiscard]] std::unique_ptr<Backend> create_motion(std::shared_ptr<const Problem> problem,
                                                     Needs needs, Machine machine);

}  // namespace sunder::finite
