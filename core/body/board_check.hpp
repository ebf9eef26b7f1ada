// SPDX-License-Identifier: Apache-2.0
// Whether model "B" may take a body for what it assumes: a flat board of even thickness.
#pragma once

#include <optional>
#include <string>

#include "sunder/mesh.hpp"

namespace sunder {

/// In words why the body is no board; nothing: it is one.
[[nodiscard]] std::optional<std::string> why_no_board(const Mesh& mesh,
                                                      const std::optional<Vec3>& plane_normal);

}  // namespace sunder
