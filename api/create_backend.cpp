// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>

#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/prepared_bodies.hpp"
#ifdef SUNDER_GPU
#include "gpu/vulkan_backend.hpp"
#include "lent_host.hpp"
#endif
#include "failover_backend.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder {
namespace {

std::vector<DeviceInfo> vulkan_devices() {
#ifdef SUNDER_GPU
  return gpu::devices();
#else
  return {};
#endif
}

#ifdef SUNDER_GPU
/// The CPU backend with options of its own: the scene's were meant for a GPU.
std::unique_ptr<Backend> create_replacement(const Problem& problem, const Needs& needs) {
  Scene scene = problem.scene();
  const double tolerance = scene.solver.tolerance;
  scene.solver = {};
  scene.solver.tolerance = tolerance;
  return cpu_reference::create(std::make_shared<const Problem>(std::move(scene)), needs);
}
#endif

#ifdef SUNDER_GPU
std::vector<std::string> warnings_of(const Backend& backend, const PipelineCache* cache) {
  std::vector<std::string> warnings = gpu::warnings(backend);
  if (cache && !cache->ignored().empty()) {
    warnings.push_back("the pipeline cache that was handed in is ignored: " + cache->ignored());
  }
  return warnings;
}
#endif

/// `warnings`: what the scene asked for and will cost more than it seems.
std::unique_ptr<Backend> create_vulkan(std::shared_ptr<const Problem> problem, Needs needs,
                                       const std::shared_ptr<PipelineCache>& cache,
                                       std::vector<std::string>& warnings) {
#ifdef SUNDER_GPU
  gpu::VulkanOptions options = gpu::options_from_environment();
  options.cache = cache;
  auto primary = gpu::create(problem, needs, options);
  warnings = warnings_of(*primary, cache.get());
  // Bodies by their laws, and those that part, go on by the host themselves, which has their state.
  if (problem->finite() || problem->moves() || needs.split) return primary;
  return with_failover(problem, std::move(primary),
                       [problem, needs] { return create_replacement(*problem, needs); });
#else
  static_cast<void>(problem);
  static_cast<void>(needs);
  static_cast<void>(cache);
  static_cast<void>(warnings);
  throw DeviceError("this build leaves out the backend vulkan (SUNDER_GPU=OFF); it has cpu");
#endif
}

/// The machine's GPU when there is one and it can do the scene, else the CPU. A GPU that is missed
/// is a warning: a build without the backend and a processor that emulates one miss none.
CreatedBackend create_automatic(const std::shared_ptr<const Problem>& problem, const Needs& needs,
                                [[maybe_unused]] const std::shared_ptr<PipelineCache>& cache) {
  CreatedBackend created;
  // Laws and motion are the processor's: its factor is quicker than any device's dense inverse so
  // far (bench_motion). So are cracks that split: its border asks for no new buffers.
  // Pooled volume and fibres are there alone.
  if (problem->finite() || problem->moves() || needs.split || problem->pools() ||
      problem->fibrous()) {
    created.backend = cpu_reference::create(problem, needs);
    return created;
  }
#ifdef SUNDER_GPU
  const std::optional<std::string> missing = gpu::missing_gpu();
  if (!missing) {
    try {
      created.backend = create_vulkan(problem, needs, cache, created.warnings);
      return created;
    } catch (const DeviceError& error) {
      created.warnings.push_back(std::string("backend vulkan failed, cpu is used instead: ") +
                                 error.what());
    }
  } else if (!missing->empty()) {
    created.warnings.push_back("backend auto found no GPU, cpu is used instead: " + *missing);
  }
#endif
  created.backend = cpu_reference::create(problem, needs);
  return created;
}

}  // namespace

std::vector<std::string> backend_names() {
#ifdef SUNDER_GPU
  return {"cpu", "vulkan"};
#else
  return {"cpu"};
#endif
}

std::vector<std::string> measure_devices(bool again) {
#ifdef SUNDER_GPU
  return gpu::measure_devices(again);
#else
  static_cast<void>(again);
  return {};
#endif
}

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> list = {cpu_reference::device()};
  for (DeviceInfo& d : vulkan_devices()) {
    if (d.chosen) {
      list.front().chosen = false;
      list.front().why = "a GPU is there";
    }
    list.push_back(std::move(d));
  }
  return list;
}

CreatedBackend create_backend(std::shared_ptr<const Problem> problem, Needs needs,
                              std::shared_ptr<PipelineCache> cache) {
  if (!problem) throw UsageError("a backend needs a problem");
  const std::string& name = problem->scene().solver.backend;
  if (name == "cpu") return {cpu_reference::create(std::move(problem), std::move(needs)), {}};
  if (name == "vulkan") {
    CreatedBackend created;
    created.backend = create_vulkan(std::move(problem), std::move(needs), cache, created.warnings);
    return created;
  }
  if (name == "auto") return create_automatic(problem, needs, cache);
  std::string names;
  for (const std::string& n : backend_names()) names += (names.empty() ? "" : ", ") + n;
  throw DeviceError("there is no backend \"" + name + "\"; this build has " + names);
}

CreatedBackend create_backend_on(std::shared_ptr<const Problem> problem, Needs needs,
                                 const sunder_vulkan_host& host,
                                 std::shared_ptr<PipelineCache> cache) {
  if (!problem) throw UsageError("a backend needs a problem");
#ifdef SUNDER_GPU
  if (problem->scene().solver.backend == "cpu") {
    throw DeviceError("the scene asks for backend \"cpu\" on a Vulkan device");
  }
  gpu::VulkanOptions options;
  options.lent = to_lent(host);
  options.cache = cache;
  CreatedBackend created;
  created.backend = gpu::create(std::move(problem), std::move(needs), options);
  created.warnings = warnings_of(*created.backend, cache.get());
  return created;
#else
  static_cast<void>(needs);
  static_cast<void>(host);
  static_cast<void>(cache);
  throw DeviceError("this build leaves out the backend vulkan (SUNDER_GPU=OFF); it has cpu");
#endif
}

std::shared_ptr<cpu_reference::PreparedBodies> prepared_bodies(std::size_t most) {
  return std::make_shared<cpu_reference::PreparedBodies>(most);
}

CreatedBackend create_prepared_backend(std::shared_ptr<const Problem> problem, Needs needs,
                                       std::shared_ptr<cpu_reference::PreparedBodies> prepared) {
  if (!problem) throw UsageError("a backend needs a problem");
  const std::string& name = problem->scene().solver.backend;
  if (name != "cpu" && name != "auto") {
    throw DeviceError("prepared bodies are shared by backend \"cpu\" alone, not by \"" + name +
                      "\"");
  }
  cpu_reference::CpuOptions options;
  options.prepared = std::move(prepared);
  return {cpu_reference::create(std::move(problem), std::move(needs), options), {}};
}

}  // namespace sunder
