// SPDX-License-Identifier: Apache-2.0
// An HTML table row by row; every cell is escaped.
#pragma once

#include <string>
#include <vector>

#include "app/output/text.hpp"

namespace sunder::app {

class Table {
 public:
  explicit Table(const std::vector<std::string>& head) { add(head, "th"); }
  void row(const std::vector<std::string>& cells) { add(cells, "td"); }
  [[nodiscard]] std::string html() const {
    return "<div class=\"scroll\"><table>\n" + rows_ + "</table></div>\n";
  }

 private:
  void add(const std::vector<std::string>& cells, const std::string& tag) {
    rows_ += "<tr>";
    for (const std::string& cell : cells)
      rows_ += "<" + tag + ">" + escaped(cell) + "</" + tag + ">";
    rows_ += "</tr>\n";
  }
  std::string rows_;
};

}  // namespace sunder::app
