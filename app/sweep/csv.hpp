// SPDX-License-Identifier: Apache-2.0
// Rows of a table whose cells may hold commas and quotes (RFC 4180), but no ends of line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sunder::app::sweep {

/// Without an end of line; those within a cell become spaces.
[[nodiscard]] std::string csv_row(const std::vector<std::string>& cells);

[[nodiscard]] std::vector<std::string> csv_cells(std::string_view row);

}  // namespace sunder::app::sweep
