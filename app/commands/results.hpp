// SPDX-License-Identifier: Apache-2.0
// The result folder of one run: what is written while it goes on and what is written at its end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/figure/figure.hpp"
#include "app/figure/film.hpp"
#include "app/output/result_folder.hpp"
#include "app/output/run_record.hpp"
#include "app/output/vtu.hpp"
#include "app/report/html.hpp"

namespace sunder::app {

class ResultWriter {
 public:
  ResultWriter(ResultFolder& folder, const Problem& problem, bool series);

  /// Removes an earlier run's results from the folder, opens frames.csv and tips.csv; once.
  void begin();

  void step_done(const StepReport& report, const State& state, const std::vector<TipState>& tips);
  void snapshot(int wanted, const State& state);
  /// Writes what is left; summary.json last, so that its presence says that all is there.
  void finish(const RunRecord& run);

  [[nodiscard]] ResultFolder& folder() const { return folder_; }
  /// Names of the files written, in order.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

 private:
  void write(const std::string& name, std::string_view text);
  /// NAME.svg and NAME.png; returns what goes into the page: the PNG, or the SVG where this build
  /// makes no PNG.
  std::string write_picture(const std::string& name, const std::string& svg);
  void write_state(const std::string& name, const State& state);
  void write_cracks(const std::string& name, const State& state);

  ResultFolder& folder_;
  const Problem& problem_;
  bool series_;
  FigurePainter painter_;
  std::optional<ResultFile> frames_, tips_;
  std::vector<SeriesEntry> series_entries_, crack_entries_;
  std::vector<SnapshotPicture> snapshots_;
  FilmReel film_;
  std::vector<std::string> files_;
};

}  // namespace sunder::app
