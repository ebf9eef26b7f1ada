// SPDX-License-Identifier: Apache-2.0
#include "app/output/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sunder/fracture_model.hpp"

namespace sunder::app {

int RunRecord::event_count() const { return destroyed.empty() ? 0 : destroyed.back().event + 1; }

int RunRecord::destroyed_count() const {
  return static_cast<int>(
      std::ranges::count(destroyed, false, [](const DestroyedElement& d) { return d.lives; }));
}

std::optional<Deformation> RunRecord::largest() const {
  std::optional<Deformation> all;
  const auto add = [&](const std::optional<Deformation>& one) {
    if (!one) return;
    if (!all) all.emplace();
    if (std::abs(one->strain) > std::abs(all->strain)) all->strain = one->strain;
    all->rotation_deg = std::max(all->rotation_deg, one->rotation_deg);
    all->inverted = std::max(all->inverted, one->inverted);
  };
  for (const StepReport& step : steps) add(step.deformation);
  if (unfinished) add(unfinished->deformation);
  if (at_first_rupture) add(at_first_rupture->deformation);
  return all;
}

double RunRecord::volume_lost() const {
  double sum = 0;
  for (const DestroyedElement& d : destroyed) {
    if (d.lives || d.cause == Cause::preset || problem.in_interface(d.element)) continue;
    sum += problem.shape(d.element).volume;
  }
  return sum;
}

StepReport RunRecord::last_report() const {
  if (unfinished) return *unfinished;
  return steps.empty() ? StepReport{} : steps.back();
}

const DestroyedElement* RunRecord::first_rupture() const {
  const auto found = std::find_if(destroyed.begin(), destroyed.end(), [](const auto& d) {
    return d.cause != Cause::preset && d.cause != Cause::script;
  });
  return found == destroyed.end() ? nullptr : &*found;
}

const std::vector<Stage>& stages() {
  static const std::vector<Stage> all = {
      {"load", &StageTimes::load},     {"solve", &StageTimes::solve},
      {"stress", &StageTimes::stress}, {"decide", &StageTimes::decide},
      {"update", &StageTimes::update}, {"total", &StageTimes::total}};
  return all;
}

TimeStatistics statistics(std::vector<double> ms) {
  if (ms.empty()) return {};
  std::sort(ms.begin(), ms.end());
  const std::size_t n = ms.size();
  const double median = (ms[(n - 1) / 2] + ms[n / 2]) / 2;
  const std::size_t rank = (99 * n + 99) / 100;  // ceil(0.99 n)
  return {ms.front(), median, ms[rank - 1], ms.back(), std::accumulate(ms.begin(), ms.end(), 0.0)};
}

TimeStatistics statistics(const std::vector<StepReport>& steps, const Stage& stage) {
  std::vector<double> ms;
  for (const StepReport& step : steps) ms.push_back(step.times.*stage.time);
  return statistics(std::move(ms));
}

bool cracks_split(const Scene& scene) {
  return scene.fracture.crack == CrackWay::split && row_of(scene.fracture.model).breaks;
}

std::string what_broke(const DestroyedElement& row) {
  const std::string by = std::string(to_string(row.cause)) + ", ";
  if (row.element != kNone) return by + "element " + std::to_string(row.element);
  return by + "crack " + std::to_string(row.crack) +
         (row.sif ? ", tip " + std::to_string(row.sif->tip) : std::string());
}

const char* name_of(FractureModel model) { return row_of(model).name; }

const char* name_of(CrackKind kind) { return kind == CrackKind::edge ? "edge" : "internal"; }

}  // namespace sunder::app
