// SPDX-License-Identifier: Apache-2.0
// What the preset crack's length does, and which remote stress Eq. 3 takes it with.
#include <algorithm>

#include "app/output/text.hpp"
#include "app/reproduce/chapters.hpp"
#include "app/reproduce/critical_load.hpp"
#include "app/reproduce/statements.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kNotchPull = 42;            // N, of scene notch-b
constexpr double kHold = 20;                 // N: a pull under which a short notch rests
constexpr double kRight = 50, kMiddle = 25;  // mm, of the notched board
constexpr double kFineSize = 1.6;            // mm: a notch of 8 mm is more than a few of them

struct Reading {
  std::string name;
  std::vector<std::string> overrides;
};

/// The K that drives the first growth, per newton of pull [MPa sqrt(mm)/N].
const std::vector<Reading>& readings() {
  static const std::vector<Reading> all = {
      {"field K", {both_k()[1].override}},
      {"line", {both_k()[0].override}},
      {"tip", {both_k()[0].override, "fracture.sigma0=tip"}},
      {"present", {both_k()[0].override, "fracture.sigma0=present"}}};
  return all;
}

struct OfLength {
  double length = 0;
  Index elements = 0;
  std::vector<std::optional<CriticalLoad>> by_reading;
};

OfLength measure(const Laboratory& lab, double length) {
  lab.tell("notch length " + rounded(length, 3) + " mm");
  OfLength row{length, lab.notch({kCoarseNotch, length, 5})->tet_count(), {}};
  for (const Reading& reading : readings())
    row.by_reading.push_back(
        critical_growth(lab, notched(lab, kCoarseNotch, length, reading.overrides)));
  return row;
}

std::optional<double> force(const std::optional<CriticalLoad>& critical) {
  return critical ? std::optional(critical->factor * kNotchPull) : std::nullopt;
}

std::optional<double> per_newton(const std::optional<CriticalLoad>& critical) {
  return critical ? std::optional(critical->sif->k / *force(critical)) : std::nullopt;
}

/// K of a reading over the field's.
std::optional<double> over_field(const OfLength& row, std::size_t reading) {
  const auto k = per_newton(row.by_reading[reading]), field = per_newton(row.by_reading[0]);
  return k && field ? std::optional(*k / *field) : std::nullopt;
}

DataTable force_table(const std::vector<OfLength>& rows) {
  DataTable table{"notch-length",
                  "Pull at which the notch grows first.",
                  {"length [mm]", "elements", "K", "critical force [N]", "K/force [MPa sqrt(mm)/N]",
                   "first growth [deg]"},
                  {},
                  true};
  for (const OfLength& row : rows)
    for (std::size_t i : {1u, 0u}) {
      const auto& critical = row.by_reading[i];
      table.rows.push_back({cell(row.length), std::to_string(row.elements), both_k()[1 - i].name,
                            cell(force(critical)), cell(per_newton(critical)),
                            cell(critical ? std::optional(critical->rise_deg) : std::nullopt)});
    }
  return table;
}

DataTable reading_table(const std::vector<OfLength>& rows) {
  DataTable table{
      "remote-stress-readings",
      "Readings of sigma0: remote stress per newton [MPa/N], and the K that Eq. 3 makes "
      "of it over the K measured from the field.",
      {"length [mm]", "sigma0", "s0/force", "K/force [MPa sqrt(mm)/N]", "K/field K"},
      {},
      true};
  for (const OfLength& row : rows)
    for (std::size_t i = 1; i < readings().size(); ++i) {
      const auto& critical = row.by_reading[i];
      table.rows.push_back(
          {cell(row.length), readings()[i].name,
           cell(critical ? std::optional(critical->sif->sigma0 / *force(critical)) : std::nullopt),
           cell(per_newton(critical)), cell(over_field(row, i))});
    }
  return table;
}

std::string reading_finding(const std::vector<OfLength>& rows, std::size_t reading) {
  std::optional<double> least, most;
  for (const OfLength& row : rows)
    if (const auto ratio = over_field(row, reading)) {
      least = std::min(least.value_or(*ratio), *ratio);
      most = std::max(most.value_or(*ratio), *ratio);
    }
  const std::string name = "sigma0 = " + readings()[reading].name + ": K by Eq. 3 is ";
  if (!least) return name + "never positive.";
  return name + rounded(*least, 2) + " to " + rounded(*most, 2) +
         " times the field's for notches of " + rounded(rows.front().length, 3) + " to " +
         rounded(rows.back().length, 3) + " mm.";
}

/// 7a, with its table.
void judge_final(const Laboratory& lab, const Effort& effort, Chapter& chapter) {
  const double size = effort.quick ? kCoarseNotch : kFineSize;
  DataTable table{"notch-length-final",
                  "Length at the end of scene notch-b with a pull of 20 N, in elements of " +
                      rounded(size, 3) + " mm.",
                  {"preset length [mm]", "K", "final length [mm]", "grown [mm]"},
                  {},
                  true};
  for (const KChoice& k : both_k())
    chapter.statements.push_back(final_lengths(lab, k, size, table.rows));
  chapter.tables.push_back(table);
}

std::vector<ChartSeries> series(
    const std::vector<OfLength>& rows, std::size_t count,
    std::optional<double> (*value)(const std::optional<CriticalLoad>&)) {
  std::vector<ChartSeries> all;
  for (std::size_t i = 0; i < count; ++i) {
    ChartSeries one{i == 0 ? readings()[0].name : "formula, sigma0 " + readings()[i].name, {}};
    for (const OfLength& row : rows)
      if (const auto y = value(row.by_reading[i])) one.points.emplace_back(row.length, *y);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

RunPlan notched(const Laboratory& lab, double size, double length,
                const std::vector<std::string>& overrides) {
  RunPlan plan{"notch-b", overrides, lab.notch({size, length, 5}), 1, {}};
  plan.overrides.push_back("crack.0.tip=[" + number(kRight - length) + "," + number(kMiddle) +
                           ",1]");
  return plan;
}

Statement final_lengths(const Laboratory& lab, const KChoice& k, double size,
                        std::vector<std::vector<std::string>>& rows) {
  std::vector<FinalLength> lengths;
  for (const double length : {4.04, 8.0, 16.0}) {
    RunPlan plan = notched(lab, size, length, {k.override, "fracture.max_events=2"});
    plan.load = kHold / kNotchPull;
    const double final = lab.run(plan).cracks.at(0).length;
    lengths.push_back({length, final});
    rows.push_back({cell(length), k.name, cell(final), cell(final - length)});
  }
  return {"7a", "The final length depends on the preset crack's length.", k.name,
          judge_final_length(lengths),
          "final crack length is strongly affected by the preset crack length"};
}

Chapter notch_length(const Laboratory& lab, const Effort& effort) {
  const std::vector<double> lengths = effort.quick
                                          ? std::vector<double>{4.04, 8, 16}
                                          : std::vector<double>{3, 4.04, 6, 8, 10, 12, 16, 20};
  Chapter chapter{
      "notch-length",
      "Effect of the preset crack's length",
      "Scene notch-b with the notch's length changed: how far it is torn in the end by 20 N, in "
      "elements of 1.6 mm (quick version: 3.939 mm); and, in elements of 3.939 mm, the pull at "
      "which it grows, and the stress intensity per newton, by "
      "each reading of the remote stress sigma0 (the intact body's mean over the crack's line, "
      "that at the tip, the mean over the line of the field as it is now).",
      {},
      {},
      {},
      {}};
  std::vector<OfLength> rows;
  for (const double length : lengths) rows.push_back(measure(lab, length));
  judge_final(lab, effort, chapter);
  chapter.tables.push_back(force_table(rows));
  chapter.tables.push_back(reading_table(rows));
  for (std::size_t i = 1; i < readings().size(); ++i)
    chapter.findings.push_back(reading_finding(rows, i));
  chapter.drawings = {
      chart_drawing("notch-length-force", "Critical force over the notch's length.",
                    series(rows, 2, force), {"length of the notch [mm]", "critical force [N]"}),
      chart_drawing("notch-length-k", "Stress intensity per newton of pull.",
                    series(rows, readings().size(), per_newton),
                    {"length of the notch [mm]", "K/force [MPa sqrt(mm)/N]"})};
  return chapter;
}

}  // namespace sunder::app::reproduce
