// SPDX-License-Identifier: Apache-2.0
#include "app/commands/results.hpp"

#include <utility>

#include "app/figure/raster.hpp"
#include "app/output/summary.hpp"
#include "app/output/tables.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

std::string padded(int value, std::size_t width) {
  const std::string digits = std::to_string(value);
  return std::string(width > digits.size() ? width - digits.size() : 0, '0') + digits;
}

}  // namespace

ResultWriter::ResultWriter(ResultFolder& folder, const Problem& problem, bool series)
    : folder_(folder), problem_(problem), series_(series), painter_(problem), film_(problem) {}

void ResultWriter::begin() {
  if (frames_) return;
  folder_.clear();
  frames_.emplace(folder_, "frames.csv").write(frames_header());
  tips_.emplace(folder_, "tips.csv").write(tips_header());
}

void ResultWriter::write(const std::string& name, std::string_view text) {
  folder_.write(name, text);
  files_.push_back(name);
}

std::string ResultWriter::write_picture(const std::string& name, const std::string& svg) {
  write(name + ".svg", svg);
  if (!draws_pixels()) return svg;
  std::string png = FigurePainter::png(svg);
  write(name + ".png", png);
  return png;
}

void ResultWriter::write_state(const std::string& name, const State& state) {
  ResultFile file(folder_, name);
  write_vtu(file, problem_, state);
  file.commit();
  files_.push_back(name);
}

void ResultWriter::write_cracks(const std::string& name, const State& state) {
  ResultFile file(folder_, name);
  write_cracks_vtu(file, state);
  file.commit();
  files_.push_back(name);
}

void ResultWriter::step_done(const StepReport& report, const State& state,
                             const std::vector<TipState>& tips) {
  frames_->write(frames_row(report));
  frames_->flush();
  for (const TipState& tip : tips) tips_->write(tips_row(report.step, tip));
  tips_->flush();
  film_.step_done(report, state);
  if (!series_) return;
  const std::string number = padded(report.step, 4);
  const std::string name = "result_" + number + ".vtu", of_cracks = "cracks_" + number + ".vtu";
  write_state(name, state);
  series_entries_.push_back({report.load_factor, name});
  if (!cracks_split(problem_.scene())) return;
  write_cracks(of_cracks, state);
  crack_entries_.push_back({report.load_factor, of_cracks});
}

void ResultWriter::snapshot(int wanted, const State& state) {
  const std::string name = "snapshot_" + std::to_string(wanted);
  std::string picture = write_picture(name, painter_.svg(state));
  write_state(name + ".vtu", state);
  snapshots_.push_back({wanted, broken(state), state.step, std::move(picture)});
}

void ResultWriter::finish(const RunRecord& run) {
  begin();
  std::string events = events_header();
  for (const DestroyedElement& record : run.destroyed) events += events_row(record);
  write("events.csv", events);
  frames_->commit();
  files_.push_back("frames.csv");
  tips_->commit();
  files_.push_back("tips.csv");
  write_state("result.vtu", run.last);
  if (series_) write("series.pvd", pvd(series_entries_));
  if (cracks_split(problem_.scene())) {
    write_cracks("cracks.vtu", run.last);
    if (series_) write("cracks.pvd", pvd(crack_entries_));
  }
  const std::string svg = painter_.svg(run.last);
  const std::string figure = write_picture("figure", svg);
  std::string film;
  if (const auto pictures = film_.pictures(); !pictures.empty()) {
    film = write_picture("film", film_strip(painter_, problem_.scene().title, pictures));
  }
  files_.push_back("summary.json");
  write("index.html", report_html(run, {svg, figure, snapshots_, film, files_}));
  folder_.write("summary.json", summary_json(run));
}

}  // namespace sunder::app
