// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <numeric>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/waiting.hpp"
#include "app/output/run_record.hpp"
#include "app/output/text.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {
namespace {

void line(const std::string& name, const std::string& value) {
  std::cout << "  " << name << std::string(name.size() < 34 ? 34 - name.size() : 1, ' ') << value
            << "\n";
}

/// Operations of the backend that one frame of this scene calls, in order.
std::vector<std::string> operations(const Problem& problem, const Needs& needs) {
  std::vector<std::string> names = {"set_load"};
  names.push_back(problem.gripped_dofs().empty()
                      ? "solve: displacement under the load"
                      : "solve: displacement under load and grips, reactions of the grips");
  if (needs.stress) names.push_back("stress: six components per element");
  if (needs.yield) names.push_back("stress summary: largest yield ratio, and where");
  if (needs.pristine) names.push_back("solve_pristine: intact body, once a step that breaks");
  if (needs.damage) names.push_back("destroy: update of rank 6 for each element of an event");
  return names;
}

void print_sizes(const Problem& problem) {
  const Index dofs = problem.dof_count();
  std::cout << "Problem\n";
  line("nodes, tetrahedra", grouped(problem.node_count()) + ", " + grouped(problem.tet_count()));
  line("unknowns",
       grouped(dofs) + " (" + grouped(3LL * problem.node_count() - dofs) + " held by supports, " +
           grouped(static_cast<long long>(problem.gripped_dofs().size())) + " driven by grips)");
  line("fracture model", name_of(problem.scene().fracture.model));
  line("steps", grouped(problem.scene().steps));
}

std::string predicted(const BackendInfo& info) {
  if (!(info.quiet_ms > 0)) return "not by backend " + info.backend + "; --measure measures it";
  std::string text = rounded(info.quiet_ms, 3) + " quiet";
  if (info.fracture_ms > 0) text += ", " + rounded(info.fracture_ms, 3) + " with a fracture";
  if (!info.predicted_by.empty()) text += ", by " + info.predicted_by;
  return text;
}

void print_engine(const Backend& backend) {
  const BackendInfo info = backend.info();
  std::cout << "Engine\n";
  line("backend",
       info.backend + " " + info.precision + " on " + info.device + " (" + info.driver + ")");
  line("route", info.route + ", update " + info.update);
  line("why", info.why);
  line("predicted frame [ms]", predicted(info));
}

void print_buffers(const Backend& backend) {
  const std::vector<BufferPlan> buffers = backend.buffers();
  std::cout << "Buffers\n";
  for (const BufferPlan& buffer : buffers)
    line(buffer.name, grouped(static_cast<long long>(buffer.bytes)) + " bytes (" +
                          byte_size(static_cast<double>(buffer.bytes)) + ")");
  const std::size_t sum = std::accumulate(
      buffers.begin(), buffers.end(), std::size_t{0},
      [](std::size_t bytes, const BufferPlan& buffer) { return bytes + buffer.bytes; });
  line("predicted memory", grouped(static_cast<long long>(sum)) + " bytes (" +
                               byte_size(static_cast<double>(sum)) + ")");
}

void print_kernels(const Backend& backend) {
  std::cout << "Kernels of a frame\n";
  for (const KernelPlan& kernel : backend.kernels()) line(kernel.name, kernel.does);
}

void print_list(const std::string& title, const std::vector<std::string>& items) {
  std::cout << title << "\n";
  for (const std::string& item : items) std::cout << "  - " << item << "\n";
  if (items.empty()) std::cout << "  nothing\n";
}

constexpr int kMeasuredSteps = 5;

/// Times of the first steps, stage by stage on the host and pass by pass on the device.
void measure_steps(const OpenedScene& scene, std::unique_ptr<Backend> backend) {
  backend->time_passes(true);
  Simulation simulation(scene.problem, std::move(backend));
  std::cout << "Measured [ms], the first steps\n";
  while (!simulation.done() && simulation.steps_done() < kMeasuredSteps) {
    const StepReport report = simulation.step();
    const StageTimes& ms = report.times;
    line("step " + std::to_string(report.step) + ", " + counted(report.events, "event"),
         "load " + rounded(ms.load, 3) + ", solve " + rounded(ms.solve, 3) + ", stress " +
             rounded(ms.stress, 3) + ", decide " + rounded(ms.decide, 3) + ", update " +
             rounded(ms.update, 3) + ", total " + rounded(ms.total, 3));
    std::string passes;
    for (const PassTime& time : report.passes) {
      passes += (passes.empty() ? "" : ", ") + std::string(time.pass) + " " +
                rounded(time.milliseconds, 3);
    }
    if (!passes.empty()) line("  device", passes);
  }
}

CreatedBackend prepared_backend(const OpenedScene& scene) {
  const Waiting waiting("preparing " + counted(scene.problem->dof_count(), "unknown"), true);
  return create_backend(scene.problem, needs_of(*scene.problem));
}

/// What a Vulkan device does in a second is measured before the first plan for one; returns what
/// did not succeed.
std::vector<std::string> measure_for(const std::string& backend) {
  const auto all = backend == "auto" ? devices() : std::vector<DeviceInfo>{};
  const bool by_device = backend == "vulkan" || std::ranges::any_of(all, [](const DeviceInfo& d) {
                           return d.chosen && d.backend == "vulkan";
                         });
  return by_device ? measure_devices(false) : std::vector<std::string>{};
}

}  // namespace

int plan(const SceneArguments& arguments, bool measure) {
  const OpenedScene scene = open_scene(arguments);
  std::vector<std::string> warnings = measure_for(scene.problem->scene().solver.backend);
  const Problem& problem = *scene.problem;
  CreatedBackend created = prepared_backend(scene);
  const Backend& backend = *created.backend;
  std::cout << problem.scene().title << "\n\n";
  print_sizes(problem);
  print_engine(backend);
  print_buffers(backend);
  print_list("Operations of a frame", operations(problem, backend.needs()));
  print_kernels(backend);
  print_list("Left out: this scene does not need it", backend.needs().left_out);
  warnings.insert(warnings.end(), scene.warnings.begin(), scene.warnings.end());
  warnings.insert(warnings.end(), problem.warnings().begin(), problem.warnings().end());
  warnings.insert(warnings.end(), created.warnings.begin(), created.warnings.end());
  if (measure) measure_steps(scene, std::move(created.backend));
  for (const std::string& warning : warnings) std::cerr << "sunder: warning: " << warning << "\n";
  return 0;
}

}  // namespace sunder::app
