// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/study_files.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "app/output/text.hpp"

namespace sunder::app::reproduce {
namespace {

using Json = nlohmann::ordered_json;

/// A number where the whole cell is one.
Json json_cell(const std::string& text) {
  if (text.empty()) return nullptr;
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && stopped == end) return value;
  return text;
}

Json json_of(const Statement& statement) {
  Json numbers = Json::array();
  for (const Figure& figure : statement.judgement.numbers)
    numbers.push_back(
        {{"name", figure.name}, {"value", figure.value ? Json(*figure.value) : Json(nullptr)}});
  return {{"id", statement.id},
          {"statement", statement.text},
          {"words", statement.words.empty() ? Json(nullptr) : Json(statement.words)},
          {"by", statement.by},
          {"verdict", to_string(statement.judgement.verdict)},
          {"rule", statement.judgement.rule},
          {"numbers", std::move(numbers)}};
}

Json json_of(const DataTable& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const std::string& text : row) cells.push_back(json_cell(text));
    rows.push_back(std::move(cells));
  }
  return {{"name", table.name},
          {"file", table.name + ".csv"},
          {"caption", table.caption},
          {"columns", table.head},
          {"rows", std::move(rows)}};
}

Json json_of(const Chapter& chapter) {
  Json statements = Json::array(), tables = Json::array(), figures = Json::array();
  for (const Statement& s : chapter.statements) statements.push_back(json_of(s));
  for (const DataTable& t : chapter.tables) tables.push_back(json_of(t));
  for (const Drawing& d : chapter.drawings)
    figures.push_back({{"file", d.name + ".svg"}, {"caption", d.caption}});
  return {{"id", chapter.id},
          {"title", chapter.title},
          {"setup", chapter.setup},
          {"statements", std::move(statements)},
          {"findings", chapter.findings},
          {"figures", std::move(figures)},
          {"tables", std::move(tables)}};
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string csv_row(const std::vector<std::string>& cells) {
  std::string row;
  for (std::size_t i = 0; i < cells.size(); ++i) row += (i ? "," : "") + csv_cell(cells[i]);
  return row + "\n";
}

std::string numbers_of(const Judgement& judgement) {
  std::string text;
  for (const Figure& figure : judgement.numbers) {
    if (!text.empty()) text += "; ";
    text += figure.name + ": " + (figure.value ? rounded(*figure.value, 3) : "none");
  }
  return text;
}

std::string quoted(const std::string& words) {
  return words.empty() ? words : " \"" + words + "\"";
}

/// Each rule once, under the statements that it judges.
std::string rules_of(const Study& study) {
  std::vector<std::pair<std::string, std::string>> rules;  // rule, ids
  for (const Chapter& chapter : study.chapters)
    for (const Statement& s : chapter.statements) {
      const auto same = std::find_if(rules.begin(), rules.end(),
                                     [&](const auto& r) { return r.first == s.judgement.rule; });
      if (same == rules.end())
        rules.emplace_back(s.judgement.rule, s.id);
      else if (same->second.find(s.id) == std::string::npos)
        same->second += ", " + s.id;
    }
  std::string text = "\n## Rules of the verdicts\n";
  for (const auto& [rule, ids] : rules) text += "\n- " + ids + ": " + rule + ".\n";
  return text;
}

/// A number with four digits, a word as it is.
std::string markdown_cell(const std::string& text) {
  const Json value = json_cell(text);
  return value.is_number() ? rounded(value.get<double>(), 4) : text;
}

std::string markdown_table(const DataTable& table) {
  std::string text = "\n" + table.caption + "\n\n|", line = "\n|";
  for (const std::string& head : table.head) {
    text += " " + head + " |";
    line += "---|";
  }
  text += line + "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (const std::string& one : row) text += " " + markdown_cell(one) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace

std::string study_json(const Study& study) {
  Json chapters = Json::array();
  for (const Chapter& chapter : study.chapters) chapters.push_back(json_of(chapter));
  const Json all = {{"program", "sunder " SUNDER_VERSION},
                    {"command", std::string("sunder reproduce") + (study.quick ? " --quick" : "")},
                    {"quick", study.quick},
                    {"device", study.device},
                    {"seconds", study.seconds},
                    {"chapters", std::move(chapters)}};
  return all.dump(1) + "\n";
}

std::string csv(const DataTable& table) {
  std::string text = csv_row(table.head);
  for (const auto& row : table.rows) text += csv_row(row);
  return text;
}

std::string study_markdown(const Study& study) {
  std::string text =
      "<!-- SPDX-License-Identifier: Apache-2.0 -->\n# The paper's statements and what comes out "
      "here\n\nWritten by `sunder reproduce" +
      std::string(study.quick ? " --quick" : "") +
      "` (`reproduction.md` in its result folder; `index.html` beside it has the figures "
      "and every number), computed on " +
      study.device + " in " + rounded(study.seconds, 3) +
      " s. Statements in our words, and quoted what the paper's title or abstract says of them; "
      "times depend on what else the machine did.\n\n"
      "| | statement | K | verdict | numbers |\n|---|---|---|---|---|\n";
  for (const Chapter& chapter : study.chapters)
    for (const Statement& s : chapter.statements)
      text += "| " + s.id + " | " + s.text + quoted(s.words) + " | " + s.by + " | **" +
              to_string(s.judgement.verdict) + "** | " + numbers_of(s.judgement) + " |\n";
  text += rules_of(study);
  for (const Chapter& chapter : study.chapters) {
    const auto& tables = chapter.tables;
    const bool tabled = std::any_of(tables.begin(), tables.end(),
                                    [](const DataTable& table) { return table.in_markdown; });
    if (chapter.findings.empty() && !tabled) continue;
    text += "\n## " + chapter.title + "\n" + chapter.setup + "\n";
    for (const std::string& finding : chapter.findings) text += "\n- " + finding + "\n";
    for (const DataTable& table : tables)
      if (table.in_markdown) text += markdown_table(table);
  }
  return text;
}

std::string standalone(const Drawing& drawing) {
  if (!drawing.chart || !drawing.svg.starts_with("<svg ")) return drawing.svg;
  // The colours of the page's light scheme (app/report/style.hpp).
  static constexpr std::string_view style =
      "<style>text{fill:#667078;font:12px DejaVu Sans,sans-serif}.label{fill:#22262a}"
      ".grid{stroke:#dedcd8}.axis{stroke:#667078}polyline{fill:none;stroke-width:1.8}"
      ".s0{stroke:#4e79a7}.s1{stroke:#e15759}.s2{stroke:#f2a93b}.s3{stroke:#59a14f}"
      ".s4{stroke:#9c6bb0}.f0{fill:#4e79a7}.f1{fill:#e15759}.f2{fill:#f2a93b}.f3{fill:#59a14f}"
      ".f4{fill:#9c6bb0}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  std::string svg = drawing.svg;
  // Width and height of the view box, for programs that ask for a size.
  const std::size_t box = svg.find("viewBox=\"0 0 ") + 13, end = svg.find('"', box);
  const std::size_t space = svg.find(' ', box);
  const std::string size = "width=\"" + svg.substr(box, space - box) + "\" height=\"" +
                           svg.substr(space + 1, end - space - 1) + "\" ";
  svg.insert(5, size + "xmlns=\"http://www.w3.org/2000/svg\" ");
  return svg.insert(svg.find('\n') + 1, style);
}

}  // namespace sunder::app::reproduce
