// SPDX-License-Identifier: Apache-2.0
// Propagation before generation; several cracks and instruments at once.
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "app/reproduce/chapters.hpp"
#include "app/reproduce/models.hpp"
#include "app/reproduce/statements.hpp"

namespace sunder::app::reproduce {
namespace {

constexpr double kNotchPull = 42, kHard = 120;  // N: of scene notch-b; far above both models' first
constexpr int kEvents = 12;

/// Events of a run in order: the cracks that each grows and starts.
struct Event {
  std::set<int> grown, started;
};

std::map<int, Event> events_of(const RunResult& run) {
  std::map<int, Event> events;
  for (const DestroyedElement& row : run.fractures()) {
    Event& event = events[row.event];
    (row.cause == Cause::sif ? event.grown : event.started).insert(row.crack);
  }
  return events;
}

/// All in one step: the snapshot before each event is the state that it was decided from.
Order order_of(const RunResult& run) {
  Order order;
  std::size_t state = 0;
  for (const auto& [id, event] : events_of(run)) {
    const bool grows = !event.grown.empty(), starts = !event.started.empty();
    order.growths += grows ? 1 : 0;
    order.births += starts ? 1 : 0;
    order.mixed += grows && starts ? 1 : 0;
    const bool yields =
        state < run.snapshots.size() && largest_free_ratio(run, run.snapshots[state]) >= 1;
    order.went_first += grows && yields ? 1 : 0;
    ++state;
  }
  return order;
}

Order order_on_notch(const Laboratory& lab, const KChoice& k) {
  std::vector<int> every(2000);
  std::iota(every.begin(), every.end(), 0);
  return order_of(lab.run({"notch-b",
                           {k.override, "time.steps=1", "instrument.0.ramp=[0,1]",
                            "fracture.max_events=" + std::to_string(kEvents)},
                           nullptr,
                           kHard / kNotchPull,
                           every}));
}

std::size_t nearest_tool(const RunResult& run, const Vec2& place) {
  const Mesh& mesh = run.problem->mesh();
  std::size_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < run.last.instruments.size(); ++i)
    for (const Index node : run.last.instruments[i].nodes) {
      const double away = (run.plane.project(mesh.nodes[node]) - place).norm();
      if (away < nearest) {
        nearest = away;
        best = i;
      }
    }
  return best;
}

Several several_of(const RunResult& run) {
  std::set<int> grown;
  Several several;
  for (const auto& [id, event] : events_of(run)) {
    grown.insert(event.grown.begin(), event.grown.end());
    several.at_once += event.grown.size() > 1 ? 1 : 0;
  }
  std::set<std::size_t> tools;
  for (const Crack& crack : run.cracks) tools.insert(nearest_tool(run, crack.path.front()));
  several.grown = static_cast<double>(grown.size());
  several.tools = static_cast<double>(tools.size());
  return several;
}

}  // namespace

Statement growth_first(const Laboratory& lab, const KChoice& k) {
  return {"6a", "A crack that can grow does so before a new rupture starts.", k.name,
          judge_propagation_first(order_on_notch(lab, k)), "a combination of multiple hypotheses"};
}

Statement several_at_once(const RunResult& run, const KChoice& k) {
  return {"6b", "Several instruments tear at several places at once.", k.name,
          judge_several(several_of(run)), "two or more hands working on the tissue simultaneously"};
}

Chapter several_cracks(const Laboratory& lab) {
  lab.tell("several cracks and instruments");
  Chapter chapter{"several-cracks",
                  "Propagation before generation, several cracks and instruments",
                  "6a: scene notch-b under 120 N at once, more than either model needs, its first "
                  "12 events. 6b: scene two-instruments, each pulling at the middle of an edge of "
                  "the un-notched board.",
                  {},
                  {},
                  {},
                  {}};
  std::vector<Model> models;
  for (const KChoice& k : both_k()) {
    chapter.statements.push_back(growth_first(lab, k));
    models.push_back({k.name, lab.run({"two-instruments", {k.override}, nullptr, 1, kSnapshots})});
    chapter.statements.push_back(several_at_once(models.back().run, k));
  }
  chapter.tables = {events_table("several-cracks-fractures", models)};
  chapter.drawings.push_back({"several-cracks",
                              "Stress and destroyed elements after 5, 10, 20 and 40 fractures.",
                              picture("Two instruments tear at two places", models)});
  return chapter;
}

}  // namespace sunder::app::reproduce
