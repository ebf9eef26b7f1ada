// SPDX-License-Identifier: Apache-2.0
// Sweeps of a board on the real program.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "app/output/program.hpp"

namespace sunder::test {

using Arguments = std::vector<std::string>;

/// Loads and yields of the tearing board: six runs, of which the last ones tear.
inline Arguments sweep_of(const TearingBoard& board, const std::filesystem::path& out,
                          Arguments more = {}) {
  Arguments arguments{
      "sweep",  board.scene.string(),       "--vary", "instrument.0.force.1=-10,-150,-200",
      "--vary", "material.upper.yield=2,4", "--out",  out.string(),
      "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Rows of sweep.csv as cells by column.
inline std::vector<std::map<std::string, std::string>> sweep_rows(
    const std::filesystem::path& folder) {
  const auto table = read_csv(folder / "sweep.csv");
  std::vector<std::map<std::string, std::string>> rows;
  for (std::size_t r = 1; r < table.size(); ++r) {
    EXPECT_EQ(table[r].size(), table[0].size());
    std::map<std::string, std::string> row;
    for (std::size_t c = 0; c < table[0].size() && c < table[r].size(); ++c) {
      row[table[0][c]] = table[r][c];
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The table but for what no two runs have alike.
inline std::vector<std::map<std::string, std::string>> without_times(
    const std::filesystem::path& folder) {
  auto rows = sweep_rows(folder);
  for (auto& row : rows) row.erase("ms");
  return rows;
}

}  // namespace sunder::test
