// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/figures.hpp"

#include <algorithm>

#include "app/figure/canvas.hpp"
#include "app/figure/figure.hpp"
#include "app/figure/film.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/svg.hpp"
#include "app/figure/tip_vectors.hpp"
#include "app/output/text.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kPanel = 300, kGap = 14, kTop = 52, kRowTitle = 24;
constexpr double kLegend = 84;

std::vector<Panel> all_panels(const std::vector<PanelRow>& rows) {
  std::vector<Panel> panels;
  for (const PanelRow& row : rows)
    for (const Panel& panel : row.panels)
      if (panel.state) panels.push_back(panel);
  return panels;
}

Bounds common_bounds(const std::vector<PanelRow>& rows) {
  Bounds bounds;
  for (const Panel& panel : all_panels(rows)) {
    const Bounds own = FigurePainter(*panel.run->problem).bounds(*panel.state);
    bounds.add(own.min);
    bounds.add(own.max);
  }
  return bounds;
}

/// The vectors' colours: by the formula and by the field, whichever the panels have.
std::string vector_keys(double top, const std::vector<PanelRow>& rows) {
  std::string out;
  double left = kGap;
  for (const auto& [drives, width] :
       {std::pair{SifSource::formula, 470.0}, std::pair{SifSource::field, 370.0}}) {
    bool any = false;
    for (const Panel& panel : all_panels(rows))
      any = any ||
            (!panel.state->growths.empty() && panel.run->problem->scene().fracture.sif == drives);
    out += tip_vector_key({left, top}, drives, any);
    if (any) left += width;
  }
  return out;
}

std::string legend(double top, bool cracks) {
  constexpr int steps = 40;
  constexpr double width = 160;
  std::string out = svg::text({kGap, top + 12}, "max. shear / yield: 0", "fill=\"#333\"");
  const double left = kGap + 150;
  for (int i = 0; i < steps; ++i)
    out += svg::rect({left + width * i / steps, top}, {width / steps + 0.5, 14},
                     "fill=\"" + hex(red((i + 0.5) / steps)) + "\"");
  out += svg::text({left + width + 6, top + 12}, "1", "fill=\"#333\"");
  return out + svg::text({kGap, top + 36},
                         std::string("Gap with outlined lips: destroyed; grey: unbreakable; ") +
                             "yellow: instruments; " + (cracks ? "blue line: crack path; " : "") +
                             "thick line: held; dashed: undeformed.",
                         "fill=\"#666\"");
}

}  // namespace

std::string montage(const std::string& title, const std::vector<PanelRow>& rows) {
  const Canvas canvas(common_bounds(rows));
  const double height = panel_height(canvas, kPanel);
  std::size_t columns = 1;
  bool cracks = false;
  for (const PanelRow& row : rows) columns = std::max(columns, row.panels.size());
  for (const Panel& panel : all_panels(rows)) cracks = cracks || !panel.state->cracks.empty();
  const double row_height = kRowTitle + kPanelTitle + height + kGap;
  const Vec2 page(kGap + static_cast<double>(columns) * (kPanel + kGap),
                  kTop + static_cast<double>(rows.size()) * row_height + kLegend);
  std::string out =
      svg::open(page.x(), page.y(),
                "font-family=\"DejaVu Sans, Verdana, sans-serif\" font-size=\"12.5\"") +
      "<title>" + escaped(title) + "</title>\n" + svg::rect({0, 0}, page, "fill=\"#fff\"") +
      svg::text({kGap, 32}, title, "font-size=\"17\" font-weight=\"bold\" fill=\"#222\"");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double top = kTop + static_cast<double>(r) * row_height;
    out += svg::text({kGap, top + 15}, rows[r].title, "font-weight=\"bold\" fill=\"#222\"");
    for (std::size_t p = 0; p < rows[r].panels.size(); ++p) {
      const Vec2 at(kGap + static_cast<double>(p) * (kPanel + kGap), top + kRowTitle);
      const Panel& of = rows[r].panels[p];
      out += of.state ? panel(FigurePainter(*of.run->problem), *of.state, of.title, canvas, at,
                              {kPanel, height})
                      : svg::text({at.x() + 2, at.y() + 14}, of.title, "fill=\"#888\"");
    }
  }
  const double below = page.y() - kLegend + 8;
  return out + legend(below, cracks) + vector_keys(below + 56, rows) + "</svg>\n";
}

}  // namespace sunder::app::reproduce
