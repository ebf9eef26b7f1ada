// SPDX-License-Identifier: Apache-2.0
// The backend of bodies at rest with a law of finite deformation.
#pragma once

#include "finite/law_backend.hpp"

namespace sunder::finite {

/// Throws as create() does.
[[nodiscard]] std::unique_ptr<Backend> create_statics(std::shared_ptr<const Problem> problem,
                                                      Needs needs, Machine machine);

}  // namespace sunder::finite
