// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/survival.hpp"

#include <algorithm>

#include "app/output/text.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr Survival kAll[] = {Survival::survives,    Survival::in_part, Survival::does_not,
                             Survival::ends_before, Survival::appears, Survival::with_neither};

/// From best to worst.
int rank(Verdict verdict) { return static_cast<int>(verdict); }

std::string shown(const std::optional<double>& value) {
  return value ? rounded(*value, 3) : std::string("none");
}

/// The same figure by the other law; pictures may be fewer there.
std::optional<double> same(const Figure& figure, const Judgement& other) {
  for (const Figure& f : other.numbers)
    if (f.name == figure.name) return f.value;
  return std::nullopt;
}

std::string figures_of(const TwoVerdicts& both) {
  std::string text;
  for (const Figure& figure : both.linear.judgement.numbers)
    text += (text.empty() ? "" : "; ") + figure.name + ": " + shown(figure.value) + " / " +
            shown(same(figure, both.other.judgement));
  return text;
}

std::string name_of(const TwoVerdicts& both) { return both.linear.id + " " + both.linear.by; }

std::string end_of(const RunNote& note) {
  if (!note.failure.empty()) return "exit code 5: " + note.failure;
  if (note.unfinished > 0) return counted(note.unfinished, "step") + " not at rest at the end";
  return note.steps < note.all ? "so many broke" : "all steps";
}

}  // namespace

const char* to_string(Survival survival) {
  switch (survival) {
    case Survival::survives:
      return "survives";
    case Survival::in_part:
      return "in part";
    case Survival::does_not:
      return "does not";
    case Survival::ends_before:
      return "the run ends before it";
    case Survival::appears:
      return "comes out here alone";
    default:
      return "comes out by neither";
  }
}

Survival survival_of(Verdict linear, Verdict other, bool ended) {
  if (linear == Verdict::no)
    return other == Verdict::no ? Survival::with_neither : Survival::appears;
  if (rank(other) <= rank(linear)) return Survival::survives;
  if (ended) return Survival::ends_before;
  return other == Verdict::partly ? Survival::in_part : Survival::does_not;
}

Survival survival_of(const TwoVerdicts& both) {
  return survival_of(both.linear.judgement.verdict, both.other.judgement.verdict,
                     std::any_of(both.runs.begin(), both.runs.end(),
                                 [](const RunNote& note) { return !note.failure.empty(); }));
}

std::string why_not(const TwoVerdicts& both) {
  const Survival survival = survival_of(both);
  if (survival == Survival::ends_before)
    for (const RunNote& note : both.runs)
      if (!note.failure.empty())
        return "scene " + note.scene + " at " + rounded(note.load, 3) +
               " times its forces: no equilibrium (exit code 5)";
  if (survival == Survival::survives || both.linear.by != "field K") return "";
  const auto without = std::count_if(both.runs.begin(), both.runs.end(),
                                     [](const RunNote& note) { return note.by_j; });
  return without == 0 ? ""
                      : "where the tip's surroundings are strained by over 10 % or turned in "
                        "themselves by over 10 deg K is sqrt(J E') (" +
                            std::to_string(without) + " of " +
                            counted(static_cast<long long>(both.runs.size()), "run") + ")";
}

DataTable survival_table(std::span<const TwoVerdicts> all) {
  DataTable table{"two-laws-statements",
                  "The statements by law linear / corotated. At finite rotations: a verdict as "
                  "good as the linear law's survives.",
                  {"", "statement", "K", "linear", "corotated", "at finite rotations",
                   "figures by linear / corotated", "why"},
                  {},
                  true,
                  true};
  for (const TwoVerdicts& both : all)
    table.rows.push_back({both.linear.id, both.linear.text, both.linear.by,
                          to_string(both.linear.judgement.verdict),
                          to_string(both.other.judgement.verdict), to_string(survival_of(both)),
                          figures_of(both), why_not(both)});
  return table;
}

DataTable figures_table(std::span<const TwoVerdicts> all) {
  DataTable table{"two-laws-figures",
                  "The figures that the statements rest on, by both laws.",
                  {"statement", "K", "figure", "linear", "corotated"},
                  {},
                  false};
  for (const TwoVerdicts& both : all)
    for (const Figure& figure : both.linear.judgement.numbers)
      table.rows.push_back({both.linear.id, both.linear.by, figure.name, cell(figure.value),
                            cell(same(figure, both.other.judgement))});
  return table;
}

std::vector<std::string> survival_findings(std::span<const TwoVerdicts> all) {
  std::vector<std::string> findings;
  for (const Survival survival : kAll) {
    std::string names;
    int count = 0;
    for (const TwoVerdicts& both : all) {
      if (survival_of(both) != survival) continue;
      names += (count++ ? ", " : "") + name_of(both);
    }
    if (count > 0)
      findings.push_back(std::string(to_string(survival)) + ": " + std::to_string(count) + " of " +
                         std::to_string(all.size()) + " (" + names + ").");
  }
  return findings;
}

DataTable runs_table(std::span<const RunNote> notes) {
  DataTable table{"two-laws-runs",
                  "Every run by law corotated, as it ended; load: times the scene's forces, at its "
                  "end.",
                  {"scene", "K", "load", "steps", "of", "broken", "not at rest", "end"},
                  {},
                  true};
  for (const RunNote& note : notes)
    table.rows.push_back({note.scene, note.k, cell(note.load), std::to_string(note.steps),
                          std::to_string(note.all), std::to_string(note.fractures),
                          std::to_string(note.unfinished), end_of(note)});
  return table;
}

}  // namespace sunder::app::reproduce
