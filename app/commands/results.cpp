// SPDX-License-Identifier: Apache-2.0
#include "app/commands/results.hpp"

#include <utility>

#include "app/figure/film.hpp"
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
    : folder_(folder), problem_(problem), series_(series), painter_(problem) {}

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

void ResultWriter::write_state(const std::string& name, const State& state) {
  ResultFile file(folder_, name);
  write_vtu(file, problem_, state);
  file.commit();
  files_.push_back(name);
}

void ResultWriter::step_done(const StepReport& report, const State& state,
                             const std::vector<TipState>& tips) {
  frames_->write(frames_row(report));
  frames_->flush();
  for (const TipState& tip : tips) tips_->write(tips_row(report.step, tip));
  tips_->flush();
  add_to_film(report, state);
  if (!series_) return;
  const std::string name = "result_" + padded(report.step, 4) + ".vtu";
  write_state(name, state);
  series_entries_.push_back({report.load_factor, name});
}

/// Of a body in motion the states that end each sixth of its time.
void ResultWriter::add_to_film(const StepReport& report, const State& state) {
  if (!problem_.moves()) return;
  constexpr long long kPictures = 6;
  const long long steps = problem_.scene().steps, before = kPictures * report.step / steps,
                  now = kPictures * (report.step + 1) / steps;
  if (now == before) return;
  film_.push_back(state);
  film_times_.push_back(report.motion->time);
}

void ResultWriter::snapshot(int wanted, const State& state) {
  const std::string name = "snapshot_" + std::to_string(wanted);
  const std::string svg = painter_.svg(state);
  std::string png = FigurePainter::png(svg);
  write(name + ".svg", svg);
  write(name + ".png", png);
  write_state(name + ".vtu", state);
  snapshots_.push_back({wanted, state.destroyed_count, state.step, std::move(png)});
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
  const std::string svg = painter_.svg(run.last);
  const std::string png = FigurePainter::png(svg);
  write("figure.svg", svg);
  write("figure.png", png);
  std::string film_png;
  if (!film_.empty()) {
    const std::string film = film_strip(painter_, problem_.scene().title, film_, film_times_);
    film_png = FigurePainter::png(film);
    write("film.svg", film);
    write("film.png", film_png);
  }
  files_.push_back("summary.json");
  write("index.html", report_html(run, {svg, png, snapshots_, film_png, files_}));
  folder_.write("summary.json", summary_json(run));
}

}  // namespace sunder::app
