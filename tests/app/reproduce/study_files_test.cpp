// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/study_files.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sunder::test {
namespace {

using namespace app::reproduce;

Study small_study(double near) {
  Study study;
  study.device = "a <device>";
  Chapter chapter{"experiment-3", "Three", "Set up & run.", {}, {}, {}, {"A finding."}};
  chapter.statements.push_back({"3a", "Nearer is earlier.", "field K",
                                judge_lower_force(near, 20, "near", "far"), "the <paper's> words"});
  chapter.tables.push_back(
      {"table", "A table.", {"name, unit", "value"}, {{"a \"b\"", "1.5"}, {"c", ""}}, true});
  chapter.drawings.push_back(
      chart_drawing("curve", "A curve.", {{"s", {{0, 1}, {1, 2}}}}, {"x", "y"}));
  study.chapters.push_back(chapter);
  return study;
}

TEST(StudyFiles, JsonHoldsVerdictRuleAndNumbers) {
  const auto json = nlohmann::json::parse(study_json(small_study(10)));
  const auto& statement = json["chapters"][0]["statements"][0];
  EXPECT_EQ(statement["verdict"], "reproduced");
  EXPECT_EQ(statement["by"], "field K");
  EXPECT_EQ(statement["numbers"][2]["value"], 0.5);
  EXPECT_FALSE(statement["rule"].get<std::string>().empty());
  EXPECT_EQ(statement["words"], "the <paper's> words");
  const auto& table = json["chapters"][0]["tables"][0];
  EXPECT_EQ(table["rows"][0], nlohmann::json::array({"a \"b\"", 1.5}));
  EXPECT_TRUE(table["rows"][1][1].is_null());
}

TEST(StudyFiles, AnotherNumberIsAnotherVerdictEverywhere) {
  const Study worse = small_study(30);
  const auto json = nlohmann::json::parse(study_json(worse));
  EXPECT_EQ(json["chapters"][0]["statements"][0]["verdict"], "not reproduced");
  EXPECT_NE(study_markdown(worse).find("**not reproduced**"), std::string::npos);
  EXPECT_EQ(study_markdown(small_study(10)).find("not reproduced"), std::string::npos);
  EXPECT_NE(study_page(worse, {}).find(">not reproduced</span>"), std::string::npos);
}

TEST(StudyFiles, PageAndMarkdownQuoteThePaperAndStateTheRule) {
  const Study study = small_study(10);
  const std::string markdown = study_markdown(study);
  EXPECT_NE(markdown.find("Nearer is earlier. \"the <paper's> words\" |"), std::string::npos);
  EXPECT_NE(markdown.find("- 3a: " + study.chapters[0].statements[0].judgement.rule),
            std::string::npos);
  EXPECT_NE(study_page(study, {}).find("<q>the &lt;paper"), std::string::npos);
}

TEST(StudyFiles, MarkdownHasTheTablesThatAskForIt) {
  Study study = small_study(10);
  study.chapters[0].findings.clear();
  EXPECT_EQ(study_markdown(study).find("## Three"), std::string::npos);
  DataTable& table = study.chapters[0].tables[0];
  table.in_markdown = true;
  table.rows = {{"word", "1.23456789"}, {"", "none"}};
  EXPECT_NE(study_markdown(study).find(
                "## Three\nSet up & run.\n\nA table.\n\n| name, unit | value |\n|---|---|\n"
                "| word | 1.235 |\n|  | none |\n"),
            std::string::npos)
      << study_markdown(study);
}

TEST(StudyFiles, CsvQuotesWhatItMust) {
  EXPECT_EQ(csv(small_study(1).chapters[0].tables[0]),
            "\"name, unit\",value\n\"a \"\"b\"\"\",1.5\nc,\n");
}

TEST(StudyFiles, PageEscapesAndChartsStandAlone) {
  const Study study = small_study(1);
  const std::string page = study_page(study, {});
  EXPECT_NE(page.find("a &lt;device&gt;"), std::string::npos);
  EXPECT_NE(page.find("Set up &amp; run."), std::string::npos);
  const std::string svg = standalone(study.chapters[0].drawings[0]);
  EXPECT_NE(svg.find("xmlns=\"http://www.w3.org/2000/svg\""), std::string::npos);
  EXPECT_NE(svg.find("width=\"560\" height=\"250\""), std::string::npos) << svg.substr(0, 300);
  EXPECT_NE(svg.find("<style>"), std::string::npos);
}

}  // namespace
}  // namespace sunder::test
