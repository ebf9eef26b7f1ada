// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/reproduce.hpp"

#include <chrono>

#include "app/figure/figure.hpp"
#include "app/figure/raster.hpp"
#include "app/reproduce/study_files.hpp"

namespace sunder::app::reproduce {
namespace {

using Clock = std::chrono::steady_clock;
using ChapterFunction = std::function<Chapter(const Laboratory&, const Effort&)>;

/// A chapter that has no shorter version.
ChapterFunction plain(Chapter (*chapter)(const Laboratory&)) {
  return [chapter](const Laboratory& lab, const Effort&) { return chapter(lab); };
}

const std::vector<ChapterFunction>& all_chapters() {
  static const std::vector<ChapterFunction> chapters = {
      pulled_board,       plain(notched_board),  pressure_distance,    plain(pressure_side),
      plain(paper_times), plain(several_cracks), plain(k_along_crack), notch_length,
      pressure_position,  pressure_angle,        mesh_study,           two_laws};
  return chapters;
}

std::string device_of(const Laboratory& lab) {
  const RunResult run = lab.run({"notch-b", {"time.steps=1"}, nullptr, 1, {}});
  return run.backend.device + " (" + run.backend.backend + ", " + run.backend.precision + ")";
}

}  // namespace

Study carry_out_study(
    const Effort& effort, const std::string& backend, const std::function<bool()>& stop,
    const std::function<void(const std::string&, std::size_t, std::size_t)>& tell) {
  const auto start = Clock::now();
  std::size_t done = 0;
  const Laboratory lab(backend, stop,
                       [&](const std::string& what) { tell(what, done, all_chapters().size()); });
  Study study;
  study.quick = effort.quick;
  study.device = device_of(lab);
  for (const ChapterFunction& chapter : all_chapters()) {
    study.chapters.push_back(chapter(lab, effort));
    ++done;
    lab.check_interrupt();
  }
  study.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return study;
}

std::vector<std::string> write_study(const Study& study, ResultFolder& folder) {
  std::vector<std::pair<std::string, std::string>> files;
  std::map<std::string, std::string> pngs;
  for (const Chapter& chapter : study.chapters) {
    for (const Drawing& drawing : chapter.drawings) {
      files.emplace_back(drawing.name + ".svg", standalone(drawing));
      if (!drawing.chart && draws_pixels()) pngs[drawing.name] = FigurePainter::png(drawing.svg);
    }
    for (const DataTable& table : chapter.tables)
      files.emplace_back(table.name + ".csv", csv(table));
  }
  for (const auto& [name, png] : pngs) files.emplace_back(name + ".png", png);
  files.emplace_back("reproduction.md", study_markdown(study));
  files.emplace_back("index.html", study_page(study, pngs));
  files.emplace_back("reproduce.json", study_json(study));

  std::vector<std::string> names;
  for (const auto& file : files) names.push_back(file.first);
  folder.clear();
  folder.announce(names);
  try {
    for (const auto& [name, text] : files) folder.write(name, text);
    folder.release();
  } catch (const OutputError&) {
    folder.drop();
    throw;
  }
  return names;
}

}  // namespace sunder::app::reproduce
