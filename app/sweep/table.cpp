// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/table.hpp"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/output/text.hpp"
#include "app/report/style.hpp"
#include "app/report/table.hpp"
#include "app/sweep/csv.hpp"
#include "app/sweep/outcome.hpp"
#include "app/sweep/page_script.hpp"

namespace sunder::app::sweep {
namespace {

using Json = nlohmann::json;

std::vector<std::string> header(const Description& sweep) {
  std::vector<std::string> names;
  for (const Axis& axis : sweep.axes) names.push_back(axis.key);
  const std::vector<std::string> rest = columns(sweep.instruments);
  names.insert(names.end(), rest.begin(), rest.end());
  return names;
}

/// A number where it is one, so that the page can plot it.
Json cell(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stopped == end && std::isfinite(value)) return value;
  return text;
}

Json data(const Description& sweep, const Rows& rows) {
  Json table = Json::array();
  for (const auto& [run, row] : rows) {
    Json line = Json::array();
    for (const std::string& value : values_of(sweep.axes, run)) line.push_back(cell(value));
    for (const std::string& value : csv_cells(row)) line.push_back(cell(value));
    table.push_back(std::move(line));
  }
  return {{"keys", sweep.axes.size()}, {"columns", header(sweep)}, {"rows", std::move(table)}};
}

/// JSON within a script: no tag can end it.
std::string in_script(const Json& json) {
  std::string out;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

std::string keys_section(const Description& sweep) {
  Table table({"varied key", "values", "first", "last"});
  for (const Axis& axis : sweep.axes) {
    table.row({axis.key, grouped(static_cast<long long>(axis.values.size())), axis.values.front(),
               axis.values.back()});
  }
  return "<section><h2>What was varied</h2>\n" + table.html() + "</section>\n";
}

}  // namespace

std::string sweep_csv(const Description& sweep, const Rows& rows) {
  std::string text = csv_row(header(sweep)) + "\n";
  for (const auto& [run, row] : rows) {
    text += csv_row(values_of(sweep.axes, run)) + "," + row + "\n";
  }
  return text;
}

std::string sweep_html(const Description& sweep, const Rows& rows, const std::string& note) {
  const std::string title = "Sweep of " + escaped(sweep.scene);
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      title + "</title>\n<style>\n" + std::string(kStyle) + std::string(kPlotStyle) +
      "</style>\n</head>\n<body>\n<main>\n<header><h1>" + title + "</h1>\n<p>" +
      counted(static_cast<long long>(rows.size()), "run") + " of " +
      grouped(run_count(sweep.axes)) + "</p></header>\n";
  if (!note.empty()) out += "<section class=\"warn\">" + escaped(note) + "</section>\n";
  return out + std::string(kPlot) + keys_section(sweep) +
         "<script>\nconst sweep = " + in_script(data(sweep, rows)) + ";\n" +
         std::string(kPlotScript) + "</script>\n</main>\n</body>\n</html>\n";
}

}  // namespace sunder::app::sweep
