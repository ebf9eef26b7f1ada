// SPDX-License-Identifier: Apache-2.0
#include "app/report/sections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "app/report/chart.hpp"
#include "app/report/table.hpp"
#include "sunder/fracture_model.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kMostEventRows = 400;
// Marks what differs between two runs of the same scene.
constexpr const char *kTimings = "<!-- timings -->\n", *kTimingsEnd = "<!-- end timings -->\n";

std::string section(const std::string& title, const std::string& body,
                    const std::string& kind = {}) {
  return "<section" + (kind.empty() ? "" : " class=\"" + kind + "\"") + "><h2>" + escaped(title) +
         "</h2>\n" + body + "</section>\n";
}

std::string list(const std::vector<std::string>& items) {
  std::string out = "<ul>\n";
  for (const std::string& item : items) out += "<li>" + escaped(item) + "</li>\n";
  return out + "</ul>\n";
}

std::string key(const std::string& value, const std::string& what) {
  return "<div><b>" + escaped(value) + "</b><span>" + escaped(what) + "</span></div>\n";
}

std::string point(const Vec2& p) {
  return "(" + rounded(p.x(), 4) + ", " + rounded(p.y(), 4) + ")";
}

std::string crack_table(const RunRecord& run) {
  const SplitMesh* split = run.last.split.get();
  std::vector<std::string> columns{"crack",     "kind",        "mouth [mm]",
                                   "tips [mm]", "length [mm]", "elements"};
  if (split) columns.emplace_back("split open [mm²]");
  Table table(columns);
  for (const Crack& crack : run.cracks) {
    std::string tips;
    for (const CrackTip& tip : crack.tips)
      tips += (tips.empty() ? "" : ", ") + point(tip.position) + (tip.ended ? " ended" : "");
    std::vector<std::string> cells{std::to_string(crack.id),
                                   name_of(crack.kind),
                                   crack.mouth ? point(*crack.mouth) : "-",
                                   tips,
                                   rounded(crack.length, 4),
                                   std::to_string(crack.elements.size())};
    if (split) cells.push_back(rounded(crack_area(*split, crack.id), 4));
    table.row(cells);
  }
  return "<h3>Cracks</h3>\n" + table.html();
}

/// One line per event, criterion, crack and tip: what those elements share.
struct EventLine {
  const DestroyedElement* first;
  int elements = 0;
  double largest_ratio = 0;
};

std::vector<EventLine> event_lines(const std::vector<DestroyedElement>& destroyed) {
  std::vector<EventLine> lines;
  const auto same = [](const DestroyedElement& a, const DestroyedElement& b) {
    return a.event == b.event && a.cause == b.cause && a.crack == b.crack &&
           a.sif.has_value() == b.sif.has_value() && (!a.sif || a.sif->tip == b.sif->tip);
  };
  for (const DestroyedElement& d : destroyed) {
    if (lines.empty() || !same(*lines.back().first, d)) lines.push_back({&d});
    ++lines.back().elements;
    lines.back().largest_ratio = std::max(lines.back().largest_ratio, d.ratio.value_or(0));
  }
  return lines;
}

std::string event_table(const RunRecord& run) {
  const std::vector<EventLine> lines = event_lines(run.destroyed);
  Table table(
      {"event",        "step",   "load factor", "criterion", "crack", "elements", "largest ratio",
       "K [MPa√mm]",   "K_a",    "K_b",         "K_c",       "θ [°]", "r [mm]",   "σ₀ [MPa]",
       "β [°]",        "a [mm]", "b [mm]",      "K_I",       "K_II",  "K_III",    "K, θ by formula",
       "K, θ by field"});
  for (std::size_t i = 0; i < std::min(lines.size(), kMostEventRows); ++i) {
    const DestroyedElement& d = *lines[i].first;
    const auto sif = [&](double SifTerms::*term) {
      return d.sif ? rounded((*d.sif).*term, 4) : std::string();
    };
    const auto field = [&](std::optional<double> SifTerms::*term) {
      return d.sif && (*d.sif).*term ? rounded(*((*d.sif).*term), 4) : std::string();
    };
    const auto pair = [&](std::optional<double> SifTerms::*k,
                          std::optional<double> SifTerms::*angle) {
      return field(k).empty() ? std::string() : field(k) + ", " + field(angle);
    };
    const std::string note(d.sif ? d.sif->field_note : "");
    const bool tipped = d.sif && d.crack != kNone;
    table.row({std::to_string(d.event),
               std::to_string(d.step),
               rounded(d.load_factor, 4),
               to_string(d.cause),
               d.crack == kNone
                   ? ""
                   : std::to_string(d.crack) + (tipped ? " tip " + std::to_string(d.sif->tip) : ""),
               d.lives ? std::string("split") : std::to_string(lines[i].elements),
               d.ratio ? rounded(lines[i].largest_ratio, 4) : "",
               sif(&SifTerms::k),
               sif(&SifTerms::k_a),
               sif(&SifTerms::k_b),
               sif(&SifTerms::k_c),
               sif(&SifTerms::theta),
               sif(&SifTerms::reach),
               sif(&SifTerms::sigma0),
               sif(&SifTerms::beta),
               sif(&SifTerms::a),
               sif(&SifTerms::b),
               field(&SifTerms::k_1),
               field(&SifTerms::k_2),
               field(&SifTerms::k_3),
               pair(&SifTerms::k_formula, &SifTerms::theta_formula),
               pair(&SifTerms::k_field, &SifTerms::theta_field) +
                   (note.empty() ? "" : " (" + note + ")")});
  }
  std::string out = "<h3>Events</h3>\n" + table.html();
  if (lines.size() > kMostEventRows)
    out += "<p class=\"note\">" + grouped(static_cast<long long>(lines.size() - kMostEventRows)) +
           " further lines are in events.csv.</p>\n";
  return out;
}

std::string chart(const std::string& svg) { return "<div>" + svg + "</div>\n"; }

ChartSeries over_steps(const RunRecord& run, const std::string& name, auto value) {
  ChartSeries series{name, {}};
  for (const StepReport& step : run.steps)
    series.points.emplace_back(step.load_factor, static_cast<double>(value(step)));
  return series;
}

std::string force_cells(const Vec3& f) {
  return rounded(f.x(), 5) + ", " + rounded(f.y(), 5) + ", " + rounded(f.z(), 5);
}

std::string definition(const std::string& term, const std::string& text) {
  return "<dt>" + escaped(term) + "</dt><dd>" + escaped(text) + "</dd>\n";
}

}  // namespace

std::string header(const RunRecord& run) {
  const Problem& problem = run.problem;
  const std::string chip = run.failure       ? "<span class=\"chip bad\">failed</span>"
                           : run.interrupted ? "<span class=\"chip bad\">interrupted</span>"
                                             : "<span class=\"chip\">done</span>";
  const FractureModelRow& model = row_of(problem.scene().fracture.model);
  return "<header><h1>" + escaped(problem.scene().title) + chip + "</h1>\n<p>" +
         escaped(counted(problem.tet_count(), "tetrahedron", "tetrahedra") + ", " +
                 counted(problem.dof_count(), "unknown") + ", " +
                 (model.breaks ? std::string("fracture model ") + model.name
                               : std::string("no fracture model")) +
                 ", " + std::to_string(run.steps.size()) + " of " +
                 counted(problem.scene().steps, "step") + ", " + run.backend.backend + " " +
                 run.backend.precision) +
         "</p></header>\n";
}

std::string key_figures(const RunRecord& run) {
  const DestroyedElement* first = run.first_rupture();
  const StepReport last = run.last_report();
  return "<div class=\"keys\">\n" +
         (run.last.split ? key(rounded(crack_area(*run.last.split), 4), "mm² split open")
                         : std::string()) +
         key(grouped(run.destroyed_count()), "elements destroyed") +
         key(grouped(run.event_count()), "events") +
         key(std::to_string(run.cracks.size()), run.cracks.size() == 1 ? "crack" : "cracks") +
         key(first ? rounded(first->load_factor, 4) : "none",
             first ? "load factor of the first rupture (" + what_broke(*first) + ")"
                   : "rupture by a criterion") +
         kTimings +
         key(rounded(statistics(run.steps, stages().back()).median, 3) + " ms", "median step") +
         kTimingsEnd + key(rounded(last.error, 2), "error estimate, last frame") + "</div>\n";
}

namespace {

/// Small strain left behind: for who looks at the picture before the warnings.
std::string beyond_theory(const RunRecord& run) {
  if (run.problem.finite()) return {};
  const auto d = run.largest();
  if (!d || (std::abs(d->strain) <= kSmallStrain && d->rotation_deg <= kSmallRotationDeg &&
             d->inverted == 0))
    return {};
  return section(
      "Beyond small strain",
      "<p>Live tissue is strained by up to " + rounded(100 * std::abs(d->strain), 3) +
          " % and turned by up to " + rounded(d->rotation_deg, 3) + "°" +
          (d->inverted > 0 ? ", and up to " + counted(d->inverted, "live element") +
                                 " at once turned inside out"
                           : "") +
          ". The law is linear, for small strains and rotations: read forces, shapes and loads at "
          "rupture as those of the model, not of tissue (docs/limits.md).</p>\n",
      "bad-box");
}

}  // namespace

std::string findings(const RunRecord& run) {
  std::string out;
  if (run.failure)
    out += section("Numerical failure", "<p>" + escaped(*run.failure) + "</p>\n", "bad-box");
  if (run.interrupted)
    out += section("Interrupted",
                   "<p>The run was stopped " +
                       std::string(run.unfinished ? "within a step" : "between two steps") +
                       "; what is shown is the state it had reached.</p>\n",
                   "bad-box");
  out += beyond_theory(run);
  if (!run.warnings.empty()) out += section("Warnings", list(run.warnings), "warn");
  return out;
}

namespace {

/// What one tip was driven by at each of its growths.
struct TipHistory {
  int crack = 0, tip = 0;
  ChartSeries k, load;  ///< over the crack's length before the growth
};

constexpr std::size_t kMostTips = 5;  // colours of a chart

std::vector<TipHistory> tip_histories(const RunRecord& run) {
  std::vector<TipHistory> tips;
  for (const DestroyedElement& row : run.destroyed) {
    if (!row.sif || row.crack == kNone) continue;
    auto tip = std::ranges::find_if(
        tips, [&](const TipHistory& t) { return t.crack == row.crack && t.tip == row.sif->tip; });
    if (tip == tips.end()) {
      const std::string name =
          "crack " + std::to_string(row.crack) + ", tip " + std::to_string(row.sif->tip);
      tip = tips.insert(tips.end(), {row.crack, row.sif->tip, {name, {}}, {name, {}}});
    }
    tip->k.points.emplace_back(row.sif->a, row.sif->k);
    tip->load.points.emplace_back(row.sif->a, row.load_factor);
  }
  std::erase_if(tips, [](const TipHistory& t) { return t.k.points.size() < 2; });
  std::ranges::stable_sort(tips, std::ranges::greater{},
                           [](const TipHistory& t) { return t.k.points.size(); });
  if (tips.size() > kMostTips) tips.resize(kMostTips);
  return tips;
}

/// K and load of the tips that have grown most often.
std::string along_the_cracks(const RunRecord& run) {
  const std::vector<TipHistory> tips = tip_histories(run);
  if (tips.empty()) return {};
  std::vector<ChartSeries> k, load;
  for (const TipHistory& tip : tips) {
    k.push_back(tip.k);
    load.push_back(tip.load);
  }
  const std::string x = "crack length a [mm]";
  return "<h3>Along the cracks</h3>\n<div class=\"charts\">\n" +
         chart(line_chart(k, {x, "K [MPa√mm] that made it grow"})) +
         chart(line_chart(load, {x, "load factor at which it grew"})) + "</div>\n";
}

}  // namespace

std::string fracture(const RunRecord& run) {
  if (run.destroyed.empty()) return section("Fracture", "<p class=\"note\">Nothing broke.</p>\n");
  return section("Fracture", (run.cracks.empty() ? "" : crack_table(run)) + along_the_cracks(run) +
                                 event_table(run));
}

namespace {

std::string energies(const RunRecord& run) {
  const auto over_time = [&](const std::string& name, auto value) {
    ChartSeries series{name, {}};
    for (const StepReport& step : run.steps)
      series.points.emplace_back(step.motion->time, value(*step.motion));
    return series;
  };
  return chart(line_chart(
             {over_time("work", [](const MotionState& m) { return m.work; }),
              over_time("strain energy", [](const MotionState& m) { return m.strain_energy; }),
              over_time("dissipated", [](const MotionState& m) { return m.dissipated(); })},
             {"time [s]", "N mm"})) +
         chart(line_chart({over_time("", [](const MotionState& m) { return m.kinetic; })},
                          {"time [s]", "kinetic energy [N mm]"}));
}

}  // namespace

std::string curves(const RunRecord& run) {
  if (run.steps.empty()) return {};
  const std::string x = "load factor";
  std::string out = "<div class=\"charts\">\n";
  if (!cracks_split(run.problem.scene()) || run.destroyed_count() > 0) {
    ChartSeries destroyed = over_steps(run, "", [](const StepReport& s) { return s.destroyed; });
    destroyed.steps = true;
    out += chart(line_chart({destroyed}, {x, "destroyed elements"}));
  }
  out += chart(line_chart({over_steps(run, "", [](const auto& s) { return s.max_yield_ratio; })},
                          {x, "largest yield ratio left after the step"}));
  out += chart(line_chart({over_steps(run, "", [](const auto& s) { return s.compliance; })},
                          {x, "compliance f·u [N mm]"}));
  out += chart(line_chart({over_steps(run, "residual", [](const auto& s) { return s.residual; }),
                           over_steps(run, "error", [](const auto& s) { return s.error; })},
                          {x, "relative", true}));
  if (run.problem.moves()) out += energies(run);
  return section("Over the steps", out + "</div>\n");
}

std::string times(const RunRecord& run) {
  std::vector<std::string> names;
  for (const Stage& stage : stages()) names.emplace_back(stage.name);
  names.pop_back();  // the total
  std::vector<std::vector<double>> bars;
  for (const StepReport& step : run.steps) {
    bars.emplace_back();
    for (std::size_t k = 0; k < names.size(); ++k)
      bars.back().push_back(step.times.*stages()[k].time);
  }
  Table table({"stage [ms]", "min", "median", "p99", "max", "sum"});
  for (const Stage& stage : stages()) {
    const TimeStatistics t = statistics(run.steps, stage);
    table.row({stage.name, rounded(t.min, 4), rounded(t.median, 4), rounded(t.p99, 4),
               rounded(t.max, 4), rounded(t.sum, 5)});
  }
  return kTimings +
         section("Time", "<div class=\"charts\"><div>" +
                             stacked_bars(names, bars, {"step", "ms per step"}) + "</div><div>" +
                             table.html() +
                             "<p class=\"note\">A step holds as many frames as events, and one."
                             "</p></div></div>\n") +
         kTimingsEnd;
}

std::string engine(const RunRecord& run) {
  const BackendInfo& b = run.backend;
  std::string out =
      "<dl>\n" + definition("device", b.device) + definition("driver", b.driver) +
      definition("backend, precision", b.backend + ", " + b.precision) +
      definition("route", b.route + ", update " + b.update) + definition("why", b.why) +
      definition("memory", byte_size(static_cast<double>(b.memory_bytes))) + "</dl>\n";
  if (!run.left_out.empty())
    out += "<h3>Left out: this scene does not need it</h3>\n" + list(run.left_out);
  return section("Engine", out);
}

std::string forces(const RunRecord& run) {
  Table table({"force on the body, last frame [N]", "x, y, z"});
  for (const InstrumentState& tool : run.last.instruments)
    table.row({tool.name, force_cells(tool.force)});
  table.row({"supports", force_cells(run.last.support_reaction)});
  return section("Reactions", table.html());
}

std::string file_list(const std::vector<std::string>& files) {
  std::string out = "<p>\n";
  for (const std::string& file : files)
    out += "<a href=\"" + escaped(file) + "\"><code>" + escaped(file) + "</code></a> \n";
  return section("Files", out + "</p>\n");
}

}  // namespace sunder::app
