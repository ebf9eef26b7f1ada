// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <iostream>
#include <string>

#include "app/commands/commands.hpp"
#include "sunder/backends.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kColumns = 6;
using Row = std::array<std::string, kColumns>;

Row row_of(const DeviceInfo& device) {
  return {(device.chosen ? "* " : "  ") + device.backend,
          std::to_string(device.index),
          device.name,
          device.driver,
          device.precisions,
          device.limits};
}

void print(const Row& row, const std::array<std::size_t, kColumns>& widths) {
  std::string line;
  for (std::size_t c = 0; c < kColumns; ++c) {
    line += row[c];
    if (c + 1 < kColumns) line += std::string(widths[c] - row[c].size() + 2, ' ');
  }
  std::cout << line << "\n";
}

}  // namespace

int list_devices(bool measure) {
  const std::vector<std::string> missing =
      measure ? measure_devices(true) : std::vector<std::string>{};
  const std::vector<DeviceInfo> all = devices();
  std::vector<Row> rows = {{"  backend", "device", "name", "driver", "precisions", "limits"}};
  for (const DeviceInfo& device : all) rows.push_back(row_of(device));
  std::array<std::size_t, kColumns> widths{};
  for (const Row& row : rows)
    for (std::size_t c = 0; c < kColumns; ++c) widths[c] = std::max(widths[c], row[c].size());
  for (const Row& row : rows) print(row, widths);
  std::cout << "\n* is what backend = \"auto\" takes.\n";
  for (const DeviceInfo& device : all)
    if (!device.why.empty())
      std::cout << device.backend << " " << device.index << ": " << device.why << "\n";
  for (const DeviceInfo& device : all)
    if (!device.rates.empty())
      std::cout << device.backend << " " << device.index << ", measured: " << device.rates << "\n";
  for (const std::string& what : missing) std::cerr << "sunder: warning: " << what << "\n";
  return 0;
}

}  // namespace sunder::app
