// SPDX-License-Identifier: Apache-2.0
// What `sunder reproduce` finds: chapters of statements with verdicts, figures and tables. All
// result files are written from this.
#pragma once

#include <string>
#include <vector>

#include "app/report/chart.hpp"
#include "app/reproduce/judgement.hpp"

namespace sunder::app::reproduce {

/// A statement of the paper with our verdict under one of the two K.
struct Statement {
  std::string id;    ///< "2a"
  std::string text;  ///< the paper's, in our words
  std::string by;    ///< "formula K", "field K", ""
  Judgement judgement;
  std::string words = {};  ///< the paper's own, from its title or abstract
};

struct Drawing {
  std::string name;  ///< of the file, without extension
  std::string caption;
  std::string svg;     ///< complete document
  bool chart = false;  ///< a chart follows the page's colours and goes in as it is
};

struct DataTable {
  std::string name;  ///< of the .csv file, without extension
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< shortest round-trip decimals or words
  bool on_page = true;
  bool in_markdown = false;  ///< stands in reproduction.md too
};

struct Chapter {
  std::string id;  ///< "experiment-1"
  std::string title;
  std::string setup;  ///< what was run, with every reading chosen
  std::vector<Statement> statements;
  std::vector<Drawing> drawings;
  std::vector<DataTable> tables;
  std::vector<std::string> findings;  ///< sentences that follow from the numbers
};

struct Study {
  bool quick = false;
  std::string device;  ///< that computed it
  std::vector<Chapter> chapters;
  double seconds = 0;
};

/// A cell: shortest decimal, or "" for what was not measured.
[[nodiscard]] std::string cell(double value);
[[nodiscard]] std::string cell(const std::optional<double>& value);

/// A chart as a document of its own.
[[nodiscard]] Drawing chart_drawing(const std::string& name, const std::string& caption,
                                    const std::vector<ChartSeries>& series, const ChartAxes& axes);

}  // namespace sunder::app::reproduce
