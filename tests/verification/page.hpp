// SPDX-License-Identifier: Apache-2.0
// Numbers as docs/verification.md prints them, and the page as the tests read it.
#pragma once

#include <string>
#include <vector>

namespace sunder::test {

[[nodiscard]] std::string text(const char* format, double value);
/// Deviation of a ratio from 1, in percent.
[[nodiscard]] std::string percent(double ratio);
/// The worst deviation, its target, and whether it is met.
[[nodiscard]] std::string verdict(double worst, double target);
/// Observed order of three values on meshes halved twice; "-" where they do not converge evenly.
[[nodiscard]] std::string order(const double (&value)[3]);
/// A line of a table.
[[nodiscard]] std::string line(const std::vector<std::string>& cells);
/// Head of a table.
[[nodiscard]] std::string head(const std::vector<std::string>& columns);

class Page {
 public:
  /// Throws std::runtime_error when the file cannot be read.
  explicit Page(const std::string& file);
  /// Cell of a column in the row that begins with `key`, in the section's first table that has
  /// both. Throws std::runtime_error naming what is missing.
  [[nodiscard]] std::string cell(const std::string& section, const std::vector<std::string>& key,
                                 const std::string& column) const;

 private:
  std::vector<std::string> lines_;
};

/// The same number up to one unit of the last digit printed (another compiler rounds differently).
[[nodiscard]] bool same_digits(const std::string& a, const std::string& b);

}  // namespace sunder::test
