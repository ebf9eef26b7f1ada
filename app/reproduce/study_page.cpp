// SPDX-License-Identifier: Apache-2.0
#include "app/output/text.hpp"
#include "app/report/style.hpp"
#include "app/report/table.hpp"
#include "app/reproduce/study_files.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr std::string_view kVerdictStyle = R"css(
.verdict { display:inline-block; padding:1px 9px; border-radius:99px; color:#fff; font-size:13px;
  white-space:nowrap; }
.verdict.reproduced { background:#3d8b37; } .verdict.partly { background:#b47a12; }
.verdict.no { background:#b3261e; }
table.verdicts td { text-align:left; white-space:normal; vertical-align:top; }
table.verdicts th { text-align:left; }
.chapter figure { margin-top:14px; }
)css";

std::string badge(Verdict verdict) {
  const char* css = verdict == Verdict::reproduced ? "reproduced"
                    : verdict == Verdict::partly   ? "partly"
                                                   : "no";
  return std::string("<span class=\"verdict ") + css + "\">" + to_string(verdict) + "</span>";
}

std::string numbers_of(const Judgement& judgement) {
  std::string html;
  for (const Figure& figure : judgement.numbers)
    html += escaped(figure.name) + ": <b>" +
            (figure.value ? rounded(*figure.value, 4) : std::string("none")) + "</b><br>";
  return html;
}

/// The paper's own words, if there are any.
std::string quoted(const std::string& words) {
  return words.empty() ? words : "<br><q>" + escaped(words) + "</q>";
}

std::string statement_rows(const std::vector<Statement>& statements, bool detailed) {
  std::string rows;
  for (const Statement& s : statements) {
    rows += "<tr><td>" + escaped(s.id) + "</td><td>" + escaped(s.text) + quoted(s.words) +
            "</td><td>" + escaped(s.by) + "</td><td>" + badge(s.judgement.verdict) + "</td><td>" +
            numbers_of(s.judgement) + "</td>";
    if (detailed) rows += "<td>" + escaped(s.judgement.rule) + "</td>";
    rows += "</tr>\n";
  }
  return rows;
}

std::string open_verdicts(bool detailed) {
  return std::string(
             "<table class=\"verdicts\"><tr><th></th><th>the paper's statement, in our words; "
             "quoted: its own</th>"
             "<th>by</th><th>verdict</th><th>numbers it rests on</th>") +
         (detailed ? "<th>rule</th>" : "") + "</tr>\n";
}

std::string drawing_html(const Drawing& drawing, const std::map<std::string, std::string>& pngs) {
  const auto png = pngs.find(drawing.name);
  const std::string picture = drawing.chart || png == pngs.end()
                                  ? drawing.svg
                                  : "<img alt=\"" + escaped(drawing.caption) +
                                        "\" src=\"data:image/png;base64," + base64(png->second) +
                                        "\">\n";
  const std::string caption = "<figcaption>" + escaped(drawing.caption) + " (<a href=\"" +
                              escaped(drawing.name) + ".svg\">SVG</a>)</figcaption>";
  return drawing.chart
             ? "<div>" + picture + "<p class=\"note\">" + escaped(drawing.caption) + "</p></div>\n"
             : "<figure class=\"paper\">\n" + picture + caption + "</figure>\n";
}

std::string table_html(const DataTable& table) {
  Table html(table.head);
  for (auto row : table.rows) {
    for (std::string& text : row)
      if (text.find('.') != std::string::npos && text.size() > 7 &&
          text.find_first_not_of("-0123456789.e+") == std::string::npos)
        text = rounded(std::stod(text), 4);
    html.row(row);
  }
  return "<h3>" + escaped(table.caption) + " (<a href=\"" + escaped(table.name) +
         ".csv\">CSV</a>)</h3>\n" + html.html();
}

std::string chapter_html(const Chapter& chapter, const std::map<std::string, std::string>& pngs) {
  std::string html = "<section class=\"chapter\" id=\"" + escaped(chapter.id) + "\"><h2>" +
                     escaped(chapter.title) + "</h2>\n<p>" + escaped(chapter.setup) + "</p>\n";
  if (!chapter.statements.empty())
    html += open_verdicts(true) + statement_rows(chapter.statements, true) + "</table>\n";
  if (!chapter.findings.empty()) {
    html += "<ul>\n";
    for (const std::string& finding : chapter.findings)
      html += "<li>" + escaped(finding) + "</li>\n";
    html += "</ul>\n";
  }
  for (const Drawing& drawing : chapter.drawings)
    if (!drawing.chart) html += drawing_html(drawing, pngs);
  html += "<div class=\"charts\">\n";
  for (const Drawing& drawing : chapter.drawings)
    if (drawing.chart) html += drawing_html(drawing, pngs);
  html += "</div>\n";
  for (const DataTable& table : chapter.tables)
    if (table.on_page) html += table_html(table);
  return html + "</section>\n";
}

}  // namespace

std::string study_page(const Study& study, const std::map<std::string, std::string>& pngs) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>The paper's "
      "experiments, reproduced</title>\n<style>" +
      std::string(kStyle) + std::string(kVerdictStyle) +
      "</style>\n</head>\n<body>\n<main>\n<header><h1>The paper's experiments</h1>\n<p>N. Kume et "
      "al., Soft tissue ablation model for surgical simulation by applying a combination of "
      "multiple hypotheses, Advanced Biomedical Engineering 2:38-46, 2013. Computed by sunder " +
      escaped(SUNDER_VERSION) + " on " + escaped(study.device) + " in " +
      rounded(study.seconds, 3) + " s" + (study.quick ? ", quick version" : "") +
      ". Nothing was tuned to the paper's pictures; every reading is one of docs/method.md." +
      "</p></header>\n<section><h2>Verdicts</h2>\n" + open_verdicts(false);
  for (const Chapter& chapter : study.chapters) html += statement_rows(chapter.statements, false);
  html += "</table>\n</section>\n";
  for (const Chapter& chapter : study.chapters) html += chapter_html(chapter, pngs);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace sunder::app::reproduce
