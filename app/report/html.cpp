// SPDX-License-Identifier: Apache-2.0
#include "app/report/html.hpp"

#include "app/output/text.hpp"
#include "app/report/sections.hpp"
#include "app/report/style.hpp"

namespace sunder::app {
namespace {

/// Above this size the picture goes in as PNG.
constexpr std::size_t kMostInlineSvg = 1'500'000;

std::string embedded(const std::string& picture, const std::string& alt) {
  const std::string type = picture.starts_with("\x89PNG") ? "png" : "svg+xml";
  return "<img alt=\"" + escaped(alt) + "\" src=\"data:image/" + type + ";base64," +
         base64(picture) + "\">\n";
}

std::string figure(const ReportPictures& pictures) {
  return "<figure class=\"paper\">\n" +
         (pictures.svg.size() <= kMostInlineSvg
              ? pictures.svg
              : embedded(pictures.picture, "Last frame: stress, destroyed elements, instruments")) +
         "</figure>\n";
}

std::string film(const RunRecord& run, const ReportPictures& pictures) {
  if (pictures.film.empty()) return {};
  const bool moves = run.problem.moves();
  return "<section><h2>" + std::string(moves ? "In motion" : "The tear") +
         "</h2>\n<figure class=\"paper\">" +
         embedded(pictures.film, moves ? "The body at true scale over the time of the run"
                                       : "The body as its cracks grow") +
         "</figure></section>\n";
}

std::string snapshots(const RunRecord& run, const ReportPictures& pictures) {
  if (pictures.snapshots.empty()) return {};
  std::string out = "<section><h2>On the way</h2>\n<div class=\"snapshots\">\n";
  for (const SnapshotPicture& s : pictures.snapshots)
    out += "<figure class=\"paper\">" +
           embedded(s.picture, "Snapshot at " + std::to_string(s.wanted) +
                                   (run.last.split ? " splits" : " destroyed elements")) +
           "<figcaption>" + counted(s.broken, run.last.split ? "split" : "element") +
           (run.last.split ? "" : " destroyed") + ", step " + std::to_string(s.step + 1) +
           "</figcaption></figure>\n";
  return out + "</div></section>\n";
}

}  // namespace

std::string report_html(const RunRecord& run, const ReportPictures& pictures) {
  const std::string title = escaped(run.problem.scene().title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
         title + "</title>\n<style>\n" + std::string(kStyle) +
         "</style>\n</head>\n<body>\n<main>\n" + header(run) + key_figures(run) + findings(run) +
         figure(pictures) + film(run, pictures) + snapshots(run, pictures) + fracture(run) +
         curves(run) + times(run) + engine(run) + forces(run) + file_list(pictures.files) +
         "</main>\n</body>\n</html>\n";
}

}  // namespace sunder::app
