// SPDX-License-Identifier: Apache-2.0
#include "verification/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace sunder::test {
namespace {

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  for (std::size_t begin = 1; begin < row.size();) {
    const std::size_t end = std::min(row.find('|', begin), row.size());
    std::string cell = row.substr(begin, end - begin);
    cell.erase(0, cell.find_first_not_of(' '));
    cell.erase(cell.find_last_not_of(' ') + 1);
    cells.push_back(cell);
    begin = end + 1;
  }
  return cells;
}

bool begins_with(const std::vector<std::string>& cells, const std::vector<std::string>& key) {
  return cells.size() > key.size() && std::equal(key.begin(), key.end(), cells.begin());
}

}  // namespace

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

std::string percent(double ratio) { return text("%+.2f %%", 100 * (ratio - 1)); }

std::string verdict(double worst, double target) {
  return text("%.2f %%", 100 * worst) + " (target " + text("%g %%", 100 * target) + ": " +
         (worst <= target ? "met" : "**not met**") + ")";
}

std::string order(const double (&value)[3]) {
  const double ratio = (value[1] - value[0]) / (value[2] - value[1]);
  return ratio > 0 ? text("%.1f", std::log2(ratio)) : "-";
}

std::string line(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

std::string head(const std::vector<std::string>& columns) {
  return "\n" + line(columns) + line(std::vector<std::string>(columns.size(), "---"));
}

Page::Page(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  for (std::string row; std::getline(in, row);) lines_.push_back(row);
}

std::string Page::cell(const std::string& section, const std::vector<std::string>& key,
                       const std::string& column) const {
  auto it = std::find(lines_.begin(), lines_.end(), "## " + section);
  if (it == lines_.end()) throw std::runtime_error("the page has no section " + section);
  std::vector<std::string> columns;
  for (++it; it != lines_.end() && !it->starts_with("## "); ++it) {
    if (!it->starts_with("|")) {
      columns.clear();
      continue;
    }
    const auto cells = cells_of(*it);
    if (columns.empty()) columns = cells;
    const auto found = std::find(columns.begin(), columns.end(), column);
    if (found == columns.end() || !begins_with(cells, key)) continue;
    const auto place = static_cast<std::size_t>(found - columns.begin());
    if (place < cells.size() && cells != columns) return cells[place];
  }
  throw std::runtime_error("section " + section + " has no row " + key.front() + " with a column " +
                           column);
}

bool same_digits(const std::string& a, const std::string& b) {
  if (a == b) return true;
  char *end_a = nullptr, *end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a), y = std::strtod(b.c_str(), &end_b);
  if (end_a == a.c_str() || std::string(end_a) != end_b) return false;
  const std::string digits(a.c_str(), static_cast<std::size_t>(end_a - a.c_str()));
  const std::size_t point = digits.find('.');
  const double decimals =
      point == std::string::npos ? 0.0 : static_cast<double>(digits.size() - point - 1);
  return std::abs(x - y) <= 1.001 * std::pow(10.0, -decimals);
}

}  // namespace sunder::test
