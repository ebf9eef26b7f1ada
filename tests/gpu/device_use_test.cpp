// SPDX-License-Identifier: Apache-2.0
// What a backend takes of its device: memory known before it is allocated, only the pipelines that
// the scene needs, one submit a frame, no field read back in a quiet one.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "device_use.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

/// No size of it is a multiple of 64.
Scene small_scene(bool gripped) {
  Scene scene;
  scene.mesh = structured_board({9, 6, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  if (gripped) {
    Instrument low;
    low.name = "low";
    low.action = Grip{Box{Vec3(-1, -0.1, -1), Vec3(11, 0.1, 2)}, Vec3(1, -2, 0.5), Axes{7}};
    scene.instruments.push_back(low);
  }
  return scene;
}

/// Why a problem is refused, before anything is allocated; empty: it is not.
std::string refusal(const std::shared_ptr<const Problem>& problem, gpu::VulkanOptions options) {
  std::size_t allocations = 0;
  options.probe.allocations = &allocations;
  try {
    static_cast<void>(gpu::create(problem, needs_with(true), options));
  } catch (const DeviceError& error) {
    EXPECT_EQ(allocations, 0u);
    return error.what();
  }
  EXPECT_GT(allocations, 0u);
  return {};
}

/// Taken where the device has `bytes`, refused by name where it has one less.
void expect_refused_under(std::size_t bytes, const std::shared_ptr<const Problem>& problem,
                          gpu::VulkanOptions options) {
  options.probe.memory = bytes;
  EXPECT_EQ(refusal(problem, options), "");
  options.probe.memory = bytes - 1;
  const std::string message = refusal(problem, options);
  EXPECT_NE(message.find("needs " + std::to_string(bytes) + " bytes"), std::string::npos)
      << message;
  EXPECT_NE(message.find("which has " + std::to_string(bytes - 1)), std::string::npos) << message;
}

std::vector<Way> ways_of_all_routes() {
  std::vector<Way> ways = all_ways();
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    for (Precision precision : {Precision::fp32, Precision::fp64}) {
      ways.push_back({variant, precision, Update::automatic, 1e-4, 0, Route::cg});
    }
  }
  return ways;
}

TEST_F(DeviceUse, MemoryIsKnownToTheByteBeforeItIsAllocated) {
  for (const bool gripped : {false, true}) {
    for (const Way& way : ways_of_all_routes()) {
      const auto problem = problem_for(small_scene(gripped), way);
      const gpu::VulkanOptions options = watched(way);
      expect_refused_under(gpu::device_use(*gpu::create(problem, needs_with(true), options)).bytes,
                           problem, options);
    }
  }
}

/// All of its volume pooled.
TEST_F(DeviceUse, MemoryOfPooledVolumeIsKnownToTheByteBeforeItIsAllocated) {
  for (const Way& way : ways_of_all_routes()) {
    if (way.update == Update::eager || !way.float64) continue;  // not offered
    const auto problem = problem_for(all_pooled(small_scene(true)), way);
    const gpu::VulkanOptions options = watched(way);
    expect_refused_under(gpu::device_use(*gpu::create(problem, needs_with(true), options)).bytes,
                         problem, options);
  }
}

/// Three rows of cells can tear, of 20.
Scene organ() {
  Scene scene;
  scene.mesh = structured_board({14, 20, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() > 22.5 && x.y() < 30 ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, 0.4, 2.0}}, {"organ", {5, 0.4, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  return scene;
}

TEST_F(DeviceUse, MemoryOfACondensedSceneIsKnownToTheByteBeforeItIsAllocated) {
  for (Way way : all_ways()) {
    if (way.update == Update::eager) continue;  // not offered
    way.route = Route::condensed;
    SCOPED_TRACE(name_of(way));
    const auto problem = problem_for(organ(), way);
    gpu::VulkanOptions options = watched(way);
    options.probe.no_float64 = !way.float64;
    const std::size_t bytes =
        gpu::device_use(*gpu::create(problem, needs_with(true), options)).bytes;
    expect_refused_under(bytes, problem, options);
  }
}

bool holds(const Backend& backend, const char* buffer) {
  return std::ranges::count(backend.buffers(), buffer, &BufferPlan::name) > 0;
}

bool says(const Backend& backend, const char* words) {
  return std::ranges::any_of(backend.needs().left_out, [&](const std::string& what) {
    return what.find(words) != std::string::npos;
  });
}

bool says_that_the_host_multiplies(const Backend& backend) {
  return says(backend, "no memory left for them: the host multiplies");
}

// What only makes a frame quicker is no reason to refuse a scene: columns of a condensed region's
// inverse, and the small matrices of damage.
TEST_F(DeviceUse, WhatADeviceMultipliesIsLeftToTheHostWhereMemoryIsShort) {
  struct Case {
    const char* name;
    Route route;
    std::optional<bool> gpu::VulkanOptions::*option;
  };
  for (const Case& of : {Case{"columns of the region (device)", Route::condensed,
                              &gpu::VulkanOptions::region_on_device},
                         Case{"small matrices of the damage (device)", Route::condensed,
                              &gpu::VulkanOptions::damage_on_device},
                         Case{"small matrices of the damage (device)", Route::inverse,
                              &gpu::VulkanOptions::damage_on_device}}) {
    SCOPED_TRACE(std::string(of.name) + (of.route == Route::inverse ? ", inverse" : ", condensed"));
    const Way way{.route = of.route};
    const auto problem = problem_for(organ(), way);
    gpu::VulkanOptions options = watched(way);
    const auto made = [&] { return gpu::create(problem, needs_with(true), options); };
    EXPECT_FALSE(holds(*made(), of.name));
    options.*of.option = true;
    for (int i = 0; i < 2; ++i) {  // the whole inverse of the region, then columns alone
      options.probe.memory = gpu::device_use(*made()).bytes;
    }
    EXPECT_TRUE(holds(*made(), of.name));
    --options.probe.memory;
    const auto short_of_it = made();
    EXPECT_FALSE(holds(*short_of_it, of.name));
    EXPECT_TRUE(says_that_the_host_multiplies(*short_of_it));
    options.probe.memory = 0;
    EXPECT_FALSE(says_that_the_host_multiplies(*made()));
    options.probe.as_gpu = true;
    (options.*of.option).reset();
    EXPECT_FALSE(holds(*made(), of.name)) << "a body of this size never comes to so many columns";
  }
}

// All of a region's inverse leaves others a tenth of the memory; a buffer that takes none of its
// columns is no reason to refuse the scene either.
TEST_F(DeviceUse, TheWholeInverseOfARegionIsThereWhereThereIsRoom) {
  const Way way{.route = Route::condensed};
  const auto problem = problem_for(organ(), way);
  gpu::VulkanOptions options = watched(way);
  options.region_on_device = true;
  const auto made = [&] { return gpu::create(problem, needs_with(true), options); };
  const std::size_t bytes = gpu::device_use(*made()).bytes;
  EXPECT_TRUE(holds(*made(), "inverse of the region (device)"));
  options.probe.memory = bytes * 10 / 9 + 64;
  EXPECT_TRUE(holds(*made(), "inverse of the region (device)"));
  EXPECT_FALSE(says(*made(), "no memory left"));
  options.probe.memory = bytes;
  EXPECT_FALSE(holds(*made(), "inverse of the region (device)"));
  EXPECT_TRUE(holds(*made(), "columns of the region (device)"));
  EXPECT_TRUE(says(*made(), "no memory left for it: columns come with the frames that need them"));
  EXPECT_FALSE(says_that_the_host_multiplies(*made()));
  options.probe.memory = 0;
  options.panel_bytes = 512;
  const auto by_host = made();
  EXPECT_FALSE(holds(*by_host, "inverse of the region (device)"));
  EXPECT_FALSE(holds(*by_host, "columns of the region (device)"));
  EXPECT_TRUE(says_that_the_host_multiplies(*by_host));
}

TEST_F(DeviceUse, MemoryOfAnInversionOnTheDeviceIsKnownBeforeItIsAllocated) {
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    for (const Update update : {Update::deferred, Update::eager}) {
      if (update == Update::eager && precision == Precision::fp32) continue;  // not offered
      const Way way{gpu::Variant::lvp, precision, update};
      SCOPED_TRACE(name_of(way));
      const auto problem = problem_for(small_scene(true), way);
      gpu::VulkanOptions options = watched(way);
      options.invert_on_device = true;
      const auto n = static_cast<std::size_t>(problem->dof_count());
      // No more than what is refused without: the next base's inverse is left out.
      std::size_t needed = n;
      std::string message;
      for (options.probe.memory = needed; !(message = refusal(problem, options)).empty();
           options.probe.memory = needed) {
        const std::size_t at = message.find("needs ");
        ASSERT_NE(at, std::string::npos) << message;
        const std::size_t more = std::stoull(message.substr(at + 6));
        ASSERT_GT(more, needed);
        needed = more;
      }
      // It is swept in fp64, in place or beside the one that is kept.
      EXPECT_GE(needed, n * n * (precision == Precision::fp64 ? 8 : 12));
      const std::size_t most =
          gpu::device_use(*gpu::create(problem, needs_with(true), options)).most_bytes;
      if (!options.probe.as_gpu) {
        EXPECT_EQ(needed, most);
      }
      expect_refused_under(needed, problem, options);
    }
  }
}

TEST_F(DeviceUse, OnlyThePipelinesThatTheSceneNeedsAreCreated) {
  const auto pipelines = [](const Scene& scene, const Way& way, bool damage) {
    const auto problem = problem_for(scene, way);
    const auto backend = gpu::create(problem, needs_with(damage), watched(way));
    if (damage) {
      const Index first = 100;
      backend->destroy({&first, 1});
    }
    return gpu::device_use(*backend).pipelines;
  };
  const Way eager{gpu::Variant::lvp, Precision::fp64, Update::eager};
  // Damage of the eager inverse: pick, update vectors, low rank, columns from the lower tiles.
  EXPECT_EQ(pipelines(small_scene(false), eager, true),
            pipelines(small_scene(false), eager, false) + 4);
  // Deferred damage needs none of its own.
  EXPECT_EQ(pipelines(small_scene(false), {}, true), pipelines(small_scene(false), {}, false));
  // Grips: one that holds them.
  EXPECT_EQ(pipelines(small_scene(true), {}, false), pipelines(small_scene(false), {}, false) + 1);
}

std::size_t buffer_bytes(const Backend& backend, const std::string& name) {
  for (const BufferPlan& b : backend.buffers()) {
    if (b.name == name) return b.bytes;
  }
  return 0;
}

TEST_F(DeviceUse, StressHasNoPipelineWhereNobodyAsksAndNothingBreaks) {
  for (const Way& way : ways_of_all_routes()) {
    if (!way.float64) continue;  // the host checks less there
    const auto problem = problem_for(small_scene(true), way);
    const auto made = [&](bool stress, bool damage) {
      Needs needs;
      needs.stress = stress;
      needs.damage = damage;
      return gpu::create(problem, needs, watched(way));
    };
    const auto none = made(false, false), stress = made(true, false), damage = made(false, true);
    EXPECT_EQ(gpu::device_use(*none).pipelines, gpu::device_use(*stress).pipelines - 1);
    EXPECT_FALSE(has_kernel(*none, "stress"));
    EXPECT_TRUE(has_kernel(*stress, "stress"));
    EXPECT_TRUE(has_kernel(*damage, "stress")) << "every event's frame is checked by its norm";
    // Per element, padded to 64: 4 corners, 12 values of shape, 8 of stress.
    const std::size_t elements = (9 * 6 * 6 + 63) / 64 * 64;
    const std::string state = "mesh and element state (device)";
    EXPECT_EQ(buffer_bytes(*none, state) + elements * (4 * 4 + 12 * 8),
              buffer_bytes(*stress, state));
    EXPECT_EQ(buffer_bytes(*none, "element stress (device)"), 16u);
    EXPECT_EQ(buffer_bytes(*stress, "element stress (device)"),
              elements * 8 * (way.precision == Precision::fp64 ? 8 : 4));
  }
}

TEST_F(DeviceUse, AFrameWithoutStressKeepsItsPromise) {
  for (const Way& way : ways_of_all_routes()) {
    if (!way.float64) continue;
    Pair pair(small_scene(true), way, Needs{});
    const auto& mesh = pair.problem().mesh();
    const std::vector<double> held(pair.problem().gripped_dofs().size(), 0.125);
    const auto force = shared_force(mesh, nodes_in(mesh, {Vec3(4.9, 4.9, -1), Vec3(11, 5.1, 2)}),
                                    Vec3(1, -2, 0.5));
    for (const double factor : {1.0, 1.5}) {  // the second is known by the first
      std::vector<double> scaled = force, moved = held;
      for (double& f : scaled) f *= factor;
      for (double& d : moved) d *= factor;
      const Load load = load_of(pair.problem(), scaled, moved);
      pair.load(load);
      pair.reference->solve();
      const SolveReport report = pair.vulkan->solve();
      EXPECT_LE(report.error, way.tolerance);
      EXPECT_GT(report.error, 0);
      const std::vector<std::uint8_t> live(mesh.tets.size(), 0);
      EXPECT_LE(displacement_error(mesh, live, Pair::displacement(*pair.vulkan),
                                   Pair::displacement(*pair.reference)),
                way.precision == Precision::fp64 ? kIntactTolerance : 1e-4);
    }
    pair.vulkan->set_load(load_of(pair.problem(), std::vector<double>(3 * mesh.nodes.size(), 1e300),
                                  std::vector<double>(held.size(), 1e300)));
    EXPECT_THROW(pair.vulkan->solve(), NumericalError);
  }
}

TEST_F(DeviceUse, EveryKernelSaysWhatItDoes) {
  for (const Way& way : ways_of_all_routes()) {
    const auto problem = problem_for(small_scene(true), way);
    const auto backend = gpu::create(problem, needs_with(true), watched(way));
    const Index first = 100;
    backend->destroy({&first, 1});  // an eager update makes its own then
    int pipelines = 0;
    for (const KernelPlan& kernel : backend->kernels()) {
      EXPECT_GT(kernel.does.size(), 10u) << kernel.name;
      const std::size_t count = kernel.does.find(" pipelines)");
      const std::size_t open = kernel.does.rfind('(', count);
      pipelines += count == std::string::npos ? 1 : std::stoi(kernel.does.substr(open + 1));
      const std::string variant = way.variant == gpu::Variant::gpu ? "_gpu_" : "_lvp_";
      EXPECT_NE(kernel.name.find(variant), std::string::npos) << kernel.name;
    }
    // An eager update puts another in the place of the one that reads the columns.
    EXPECT_EQ(pipelines,
              gpu::device_use(*backend).pipelines - (way.update == Update::eager ? 1 : 0));
    EXPECT_EQ(has_kernel(*backend, "low_rank"), way.update == Update::eager);
    EXPECT_EQ(has_kernel(*backend, "cg_step"), way.route == Route::cg);
    EXPECT_EQ(has_kernel(*backend, "apply"), way.route != Route::cg);
    EXPECT_TRUE(has_kernel(*backend, "hold") || !way.float64);
  }
}

void expect_frames_of_one_submit(const gpu::VulkanOptions& options) {
  const auto problem = problem_for(held_board(), {gpu::Variant::lvp, Precision::fp32});
  const auto backend = gpu::create(problem, needs_with(true), options);
  const auto nodes = nodes_in(problem->mesh(), lower_right_corner());
  const auto frame = [&](double force) {
    backend->set_load(pull(*problem, nodes, Vec3(0, -force, 0)));
    const std::size_t before = gpu::device_use(*backend).submits;
    backend->solve();
    EXPECT_EQ(gpu::device_use(*backend).submits, before + 1) << "force " << force;
    return backend->stress();
  };
  // The first load sends its columns of the inverse over, by copies where memory is not mapped.
  backend->set_load(pull(*problem, nodes, Vec3(0, -10, 0)));
  backend->solve();
  const std::size_t read = gpu::bytes_read(*backend), held = gpu::device_use(*backend).bytes;
  for (int i = 1; i < 5; ++i) {
    const StressSummary summary = frame(10 * i);
    EXPECT_GT(summary.any.ratio, 0);
  }
  for (Index e : crack_sequence(*problem, 10, 10)) {
    backend->destroy({&e, 1});
    frame(40);
  }
  EXPECT_EQ(gpu::bytes_read(*backend), read);
  EXPECT_EQ(gpu::device_use(*backend).bytes, held) << "a frame allocated device memory";
}

TEST_F(DeviceUse, AFrameIsOneSubmitAndAQuietOneReadsNoFieldBack) {
  for (const bool as_gpu : {false, true}) {
    SCOPED_TRACE(as_gpu ? "fields that the host reaches by copies" : "mapped fields");
    gpu::VulkanOptions options = watched();
    options.probe.as_gpu = options.probe.as_gpu || as_gpu;
    expect_frames_of_one_submit(options);
  }
}

TEST_F(DeviceUse, TheDeviceListsWhatIsOverYield) {
  for (const gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const Way way{variant, precision};
      const auto problem = problem_for(held_board(), way);
      const auto backend = gpu::create(problem, needs_with(true), watched(way));
      const Index gone = crack_sequence(*problem, 1, 10).front();
      backend->destroy({&gone, 1});
      for (const double force : {10.0, 2000.0, 800.0}) {
        backend->set_load(
            pull(*problem, nodes_in(problem->mesh(), lower_right_corner()), Vec3(0, -force, 0)));
        backend->solve();
        const StressSummary summary = backend->stress();
        std::vector<Voigt> stress(problem->mesh().tets.size());
        backend->read_stress(stress);
        std::vector<Index> expected;
        for (Index e = 0; e < problem->tet_count(); ++e) {
          if (e == gone || !problem->breakable(e)) continue;
          const double ratio = max_shear(stress[e]) / problem->yield(e);
          ASSERT_GT(std::abs(ratio - 1), 1e-5) << "element " << e << " is too near to yield";
          if (ratio >= 1) expected.push_back(e);
        }
        EXPECT_EQ(gpu::over_yield(*backend), expected);
        EXPECT_EQ(summary.over, static_cast<Index>(expected.size()));
        if (force == 2000.0) {
          EXPECT_GT(expected.size(), 20u);
        }
      }
    }
  }
}

TEST_F(DeviceUse, PassesAreTimedWhenAskedFor) {
  const auto problem = problem_for(held_board(), {});
  const auto backend = gpu::create(problem, needs_with(true), watched());
  backend->set_load(corner_pull(*problem));
  backend->solve();
  EXPECT_TRUE(backend->take_pass_times().empty());
  backend->time_passes(true);
  backend->solve();
  const auto times = backend->take_pass_times();
  for (const char* pass : {"solve", "stress"}) {
    const auto found = std::find_if(times.begin(), times.end(), [&](const PassTime& t) {
      return std::string(t.pass) == pass && t.milliseconds > 0;
    });
    EXPECT_NE(found, times.end()) << pass;
  }
  EXPECT_TRUE(backend->take_pass_times().empty());
}

// Counted with memory that the host maps and with memory that it does not. A cold simulation shows
// that the first step takes more otherwise.
TEST_F(DeviceUse, AStepAfterAWarmUpSubmitsNoMoreThanTheNext) {
  for (const bool as_gpu : {false, true}) {
    const auto submits = [&](bool warm) {
      Scene scene = small_scene(false);
      scene.instruments.push_back(
          {"pull", Pull{Box{Vec3(-1, -0.1, -1), Vec3(11, 0.1, 2)}, Vec3(0, -1e-3, 0)}, {}});
      scene.fracture.model = FractureModel::a;
      scene.steps = 9;
      const auto problem = problem_for(std::move(scene), {});
      gpu::VulkanOptions options = watched();
      options.probe.as_gpu = as_gpu;
      std::size_t allocations = 0;
      options.probe.allocations = &allocations;
      Simulation simulation(problem, gpu::create(problem, needs_of(*problem), options));
      if (warm) simulation.warm_up();
      std::vector<std::size_t> counts;
      for (int step = 0; step < 3; ++step) {
        simulation.drive(0, Vec3(1e-3 * (step + 1), -1e-3, 1e-3 * step * step - 2e-3));
        const std::size_t before = gpu::device_use(simulation.backend()).submits + allocations;
        simulation.step();
        counts.push_back(gpu::device_use(simulation.backend()).submits + allocations - before);
      }
      return counts;
    };
    const auto cold = submits(false), warm = submits(true);
    EXPECT_GT(cold[0], warm[0]);
    EXPECT_EQ(warm[0], warm[1]);
    EXPECT_EQ(warm[1], warm[2]);
  }
}

}  // namespace
}  // namespace sunder::test
