// SPDX-License-Identifier: Apache-2.0
// Selections of nodes and elements, and axes, as scenes write them.
#pragma once

#include "app/input/toml_table.hpp"
#include "sunder/scene.hpp"

namespace sunder::app {

/// box, nodes, near + radius, or surface: exactly one.
[[nodiscard]] NodeSelection read_nodes(const TomlTable& table);

/// volume, elements or box: exactly one of those in `keys`.
[[nodiscard]] ElementSelection read_elements(const TomlTable& table,
                                             const std::vector<std::string>& keys);

/// `axes`, default all three.
[[nodiscard]] Axes read_axes(const TomlTable& table);

/// The one of `keys` that the table has; none or two of them are errors.
[[nodiscard]] std::string require_one(const TomlTable& table, const std::vector<std::string>& keys);

}  // namespace sunder::app
