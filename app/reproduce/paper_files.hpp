// SPDX-License-Identifier: Apache-2.0
// Files of scenes/ that the program carries.
#pragma once

#include <string_view>

namespace sunder::app::reproduce {

/// Text of "notch-b.toml", "meshes/board1954.msh", ...; throws std::out_of_range for others.
[[nodiscard]] std::string_view paper_file(std::string_view name);

}  // namespace sunder::app::reproduce
