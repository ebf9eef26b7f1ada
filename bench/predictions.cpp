// SPDX-License-Identifier: Apache-2.0
// What frames will take on GPUs that were not at hand. Each body runs on the Vulkan device that
// there is, which says that it is a discrete GPU: plan, submits and dispatches of a frame are
// counted; bytes and flops of its passes, and milliseconds by two sets of rates, are the cost
// model's (core/solver/frame_cost). Prints a table in Markdown, and under it what a GPU of a data
// center would plan for the body that conjugate gradients carry there: that is not run. Minutes on
// lavapipe, and 4 GB.
//   bench_predictions [TETRAHEDRA]     at most so many
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "body/analysis.hpp"
#include "gpu/host_update.hpp"
#include "gpu/plan_device.hpp"
#include "gpu/vulkan_backend.hpp"
#include "torn_patch.hpp"

namespace sunder::bench {
namespace {

struct Body {
  Index cells, patch;  // of the board, and of what alone can tear, by route condensed; 0: all of it
  int events;          // before the frames that are counted
};

constexpr std::array<Body, 7> kBodies = {{{18, 0, 0},
                                          {36, 0, 0},
                                          {71, 0, 0},
                                          {71, kPatch, 0},
                                          {409, 40, 0},
                                          {409, 40, 300},
                                          {409, 40, 600}}};

std::shared_ptr<Problem> problem_of(const Body& body) {
  Scene scene = patch_scene(body.cells, body.patch == 0 ? kPatch : body.patch);
  if (body.patch == 0) scene.materials["organ"].yield = 2.0;
  if (body.patch > 0) scene.solver.route = Route::condensed;
  scene.solver.backend = "vulkan";
  return std::make_shared<Problem>(std::move(scene));
}

Needs needs_of_a_frame() {
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  return needs;
}

class Frames {
 public:
  explicit Frames(const Body& body) : problem_(problem_of(body)), order_(patch_tear(*problem_)) {
    gpu::VulkanOptions options;
    options.probe.as_gpu = true;
    backend_ = gpu::create(problem_, needs_of_a_frame(), options);
    for (Index n : problem_->instrument_nodes()[0].nodes) {
      load_.force_dofs.push_back(problem_->dof(n, 1));
      load_.forces.push_back(-30);
    }
    frame(0);  // has the full check
    for (int i = 0; i < body.events; ++i) frame(1);
  }

  gpu::DeviceUse frame(std::size_t broken) {
    const gpu::DeviceUse before = gpu::device_use(*backend_);
    if (broken > 0) backend_->destroy({&order_[next_], broken});
    next_ += broken;
    for (double& f : load_.forces) f *= 1.0009765625;
    backend_->set_load(load_);
    backend_->solve();
    backend_->stress();
    gpu::DeviceUse use = gpu::device_use(*backend_);
    use.submits -= before.submits;
    use.dispatches -= before.dispatches;
    return use;
  }
  [[nodiscard]] const Backend& backend() const { return *backend_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }

 private:
  std::shared_ptr<const Problem> problem_;
  std::vector<Index> order_;
  std::unique_ptr<Backend> backend_;
  Load load_;
  std::size_t next_ = 0;
};

void print(const Body& body) {
  Frames frames(body);
  for (const std::size_t broken : {1, 0}) frames.frame(broken);
  const auto by = [&](double bytes, double flops) {
    return gpu::predicted(frames.backend(), gpu::rates_of_a_gpu(bytes, flops));
  };
  const solver::FrameCost small = by(400e9, 300e9), large = by(2e12, 10e12);
  for (const bool torn : {false, true}) {
    const gpu::DeviceUse use = frames.frame(torn ? 1 : 0);
    const auto& of = torn ? small.fracture : small.quiet;
    const auto& by_large = torn ? large.fracture : large.quiet;
    std::printf("| %lld, %s%s | %s | %zu; %.0f | %zu; %.0f | %.3g | %.3g | %.3g | %.3g |\n",
                static_cast<long long>(frames.problem().tet_count()),
                frames.backend().info().route.c_str(),
                body.events > 0 ? (", after " + std::to_string(body.events)).c_str() : "",
                torn ? "fracture" : "quiet", use.submits, of.submits, use.dispatches, of.dispatches,
                1e-6 * of.bytes, 1e-6 * of.flops, of.ms, by_large.ms);
    std::fflush(stdout);
  }
}

/// What `auto` takes there for a body all of which can tear, by the cost model alone.
void print_by_a_data_center(const Body& body) {
  constexpr double kBytes = 4.8e12, kFlops = 34e12;
  constexpr std::size_t kMemory = 141'000'000'000;
  vulkan::PhysicalDevice card;
  card.type = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
  card.float64 = true;
  card.memory = kMemory;
  solver::PlanDevice device = gpu::plan_device(card, false);
  device.rates = gpu::rates_of_a_gpu(kBytes, kFlops);
  const auto problem = problem_of(body);
  const solver::Plan plan = solver::make_plan(*problem, needs_of_a_frame(), device);
  solver::FrameShape shape = plan.shape(*problem, needs_of_a_frame());
  shape.apart = shape.stress = true;
  shape.stressed = shape.elements;
  shape.real_bytes = plan.fp64 ? sizeof(double) : sizeof(float);
  shape.inverse_bytes = plan.exact_inverse ? sizeof(double) : shape.real_bytes;
  shape.exact_loads = gpu::kExactLoads;
  shape.columns_there = plan.exact_inverse;
  shape.entries = fem::analyse(*problem)->entries();
  const solver::FrameCost cost = solver::frame_cost(shape, device.rates);
  std::printf(
      "\nNot run: at 4.8 TB/s, 34 TFLOP/s and 141 GB `auto` takes route %s for the %lld tetrahedra "
      "all of which can tear (%s). Predicted: quiet %.3g ms (%.0f dispatches, %.3g MB), fracture "
      "%.3g ms (%.0f submits, %.0f dispatches, %.3g MB).\n",
      solver::name_of(plan.route).c_str(), static_cast<long long>(problem->tet_count()),
      plan.why.c_str(), cost.quiet.ms, cost.quiet.dispatches, 1e-6 * cost.quiet.bytes,
      cost.fracture.ms, cost.fracture.submits, cost.fracture.dispatches,
      1e-6 * cost.fracture.bytes);
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  setenv("SUNDER_CACHE_DIR", "", 1);  // the plan goes by no rates that were measured of lavapipe
  const long most = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 1'003'686;
  std::puts(
      "| tetrahedra, route | frame | submits: counted; predicted | dispatches | MB | Mflop | ms at "
      "400 GB/s, 300 GFLOP/s | ms at 2 TB/s, 10 TFLOP/s |\n|---|---|---|---|---:|---:|---:|---:|");
  for (const auto& body : sunder::bench::kBodies) {
    if (6L * body.cells * body.cells <= most) sunder::bench::print(body);
  }
  sunder::bench::print_by_a_data_center(sunder::bench::kBodies[2]);
}
