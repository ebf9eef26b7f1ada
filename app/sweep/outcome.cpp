// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/outcome.hpp"

#include <chrono>
#include <map>
#include <utility>

#include "app/output/run_record.hpp"
#include "app/output/text.hpp"
#include "app/sweep/csv.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app::sweep {
namespace {

using Clock = std::chrono::steady_clock;

/// Cells by column; what has no value here stays empty.
using Cells = std::map<std::string, std::string>;

struct Status {
  int exit_code;
  const char* name;
};
constexpr Status kStatus[] = {{0, "done"}, {3, "bad input"}, {4, "no device"}, {5, "numerical"}};

const char* status_of(int exit_code) {
  for (const Status& status : kStatus) {
    if (status.exit_code == exit_code) return status.name;
  }
  return "refused";
}

void put(Cells& cells, const std::string& name, const Vec3& value) {
  constexpr const char* kAxes[] = {"_x", "_y", "_z"};
  for (int axis = 0; axis < 3; ++axis) cells[name + kAxes[axis]] = number(value[axis]);
}

void put_first_rupture(Cells& cells, const RunRecord& record) {
  const DestroyedElement* first = record.first_rupture();
  if (!first) return;
  cells["first_step"] = std::to_string(first->step);
  cells["first_load_factor"] = number(first->load_factor);
  if (first->element != kNone) cells["first_element"] = std::to_string(first->element);
  cells["first_criterion"] = to_string(first->cause);
}

void put_motion(Cells& cells, const std::optional<MotionState>& motion) {
  if (!motion) return;
  cells["time"] = number(motion->time);
  cells["kinetic"] = number(motion->kinetic);
  cells["strain_energy"] = number(motion->strain_energy);
  cells["work"] = number(motion->work);
  cells["dissipated"] = number(motion->dissipated());
}

void put_instruments(Cells& cells, const Simulation& simulation, int instruments) {
  const std::vector<Vec3> forces = simulation.reactions();
  const std::vector<Vec3> u = simulation.displacement();
  for (int i = 0; i < instruments && i < static_cast<int>(forces.size()); ++i) {
    const auto at = static_cast<std::size_t>(i);
    put(cells, "reaction_" + std::to_string(i), forces[at]);
    Vec3 sum = Vec3::Zero();
    const std::vector<Index> nodes = simulation.acting_nodes(at);
    for (Index n : nodes) sum += u[static_cast<std::size_t>(n)];
    if (!nodes.empty()) {
      put(cells, "moved_" + std::to_string(i), sum / static_cast<double>(nodes.size()));
    }
  }
  put(cells, "support", simulation.support_reaction());
}

void put_record(Cells& cells, const RunRecord& record) {
  const StepReport last = record.last_report();
  cells["steps_done"] = std::to_string(record.steps.size());
  cells["events"] = std::to_string(record.event_count());
  cells["destroyed"] = std::to_string(record.destroyed_count());
  cells["cracks"] = std::to_string(record.cracks.size());
  put_first_rupture(cells, record);
  double length = 0;
  for (const Crack& crack : record.cracks) length += crack.length;
  cells["crack_length"] = number(length);
  cells["volume_lost"] = number(record.volume_lost());
  cells["compliance"] = number(last.compliance);
  cells["residual"] = number(last.residual);
  cells["error"] = number(last.error);
  cells["max_yield_ratio"] = number(last.max_yield_ratio);
  if (const auto largest = record.largest()) {
    cells["strain_max"] = number(largest->strain);
    cells["rotation_max_deg"] = number(largest->rotation_deg);
    cells["inverted"] = std::to_string(largest->inverted);
  }
  put_motion(cells, last.motion);
}

/// False: stopped.
bool run_steps(Simulation& simulation, RunRecord& record, const std::function<bool()>& stop) {
  simulation.observe_events([&](std::span<const DestroyedElement>) { return !stop(); });
  while (!simulation.done()) {
    if (stop()) return false;
    record.steps.push_back(simulation.step());
    if (simulation.interrupted()) return false;
  }
  return true;
}

/// Into `cells` all that there is, also where it throws.
bool simulate(const std::shared_ptr<const Problem>& problem,
              const std::shared_ptr<cpu_reference::PreparedBodies>& prepared, int instruments,
              const std::function<bool()>& stop, Cells& cells) {
  Simulation simulation(problem,
                        create_prepared_backend(problem, needs_of(*problem), prepared).backend);
  RunRecord record(*problem);
  const auto take = [&] {
    record.destroyed = simulation.destroyed();
    record.cracks = simulation.cracks();
    put_record(cells, record);
    cells["warnings"] = std::to_string(simulation.warnings().size());
  };
  try {
    if (!run_steps(simulation, record, stop)) return false;
  } catch (const NumericalError&) {
    take();
    throw;
  }
  take();
  put_instruments(cells, simulation, instruments);
  return true;
}

}  // namespace

std::vector<std::string> columns(int instruments) {
  std::vector<std::string> names = {
      "run",           "status",           "steps_done",   "events",
      "destroyed",     "cracks",           "first_step",   "first_load_factor",
      "first_element", "first_criterion",  "crack_length", "volume_lost",
      "compliance",    "residual",         "error",        "max_yield_ratio",
      "strain_max",    "rotation_max_deg", "inverted",     "support_x",
      "support_y",     "support_z"};
  for (int i = 0; i < instruments; ++i) {
    for (const char* what : {"reaction_", "moved_"}) {
      for (const char* axis : {"_x", "_y", "_z"}) names.push_back(what + std::to_string(i) + axis);
    }
  }
  names.insert(names.end(), {"time", "kinetic", "strain_energy", "work", "dissipated", "warnings",
                             "ms", "message"});
  return names;
}

int exit_code_of(const std::string& row) {
  const std::vector<std::string> cells = csv_cells(row);
  for (const Status& status : kStatus) {
    if (cells.size() > 1 && cells[1] == status.name) return status.exit_code;
  }
  return 2;
}

std::optional<Outcome> compute(RunIndex run,
                               const std::function<std::shared_ptr<const Problem>()>& make_problem,
                               const std::shared_ptr<cpu_reference::PreparedBodies>& prepared,
                               int instruments, const std::function<bool()>& stop) {
  const auto start = Clock::now();
  Cells cells;
  int exit_code = 0;
  try {
    if (!simulate(make_problem(), prepared, instruments, stop, cells)) return {};
  } catch (const Error& error) {
    exit_code = error.exit_code();
    cells["message"] = error.what();
  }
  cells["run"] = std::to_string(run);
  cells["status"] = status_of(exit_code);
  cells["ms"] = rounded(std::chrono::duration<double, std::milli>(Clock::now() - start).count(), 4);
  std::vector<std::string> row;
  for (const std::string& name : columns(instruments)) row.push_back(cells[name]);
  return Outcome{run, csv_row(row)};
}

}  // namespace sunder::app::sweep
