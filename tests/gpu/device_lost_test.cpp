// SPDX-License-Identifier: Apache-2.0
// A device lost at any submit of a run: the CPU goes on from the last frame, and nothing that the
// run tells is lost or told twice.
#include "failover_backend.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

Scene torn_board(FractureModel model, int steps, int max_events) {
  Scene scene = pulled_board(Vec3(0, -130, 0));
  scene.instruments.front().ramp = Ramp{0, 1};
  scene.fracture.model = model;
  scene.fracture.birth = CrackBirth::through;
  scene.fracture.max_events = max_events;
  scene.removals.push_back({1, std::vector<Index>{700, 701}});
  scene.steps = steps;
  return scene;
}

struct Told {
  std::vector<DestroyedElement> destroyed;
  std::vector<Crack> cracks;
  std::vector<StepReport> steps;
  std::vector<Vec3> displacement;
  std::vector<Voigt> stress;
  std::vector<std::string> warnings;
  BackendInfo backend;
};

Told tell(const std::shared_ptr<const Problem>& problem, std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  Told told;
  while (!simulation.done()) told.steps.push_back(simulation.step());
  told.destroyed = simulation.destroyed();
  told.cracks = simulation.cracks();
  told.displacement = simulation.displacement();
  told.stress = simulation.stress();
  told.warnings = simulation.warnings();
  told.backend = simulation.backend().info();
  return told;
}

/// Relative differences that the accuracy table allows.
struct Allowed {
  double ratio, compliance, stress;
};
constexpr Allowed kAllowedFp64{1e-6, 1e-7, kCrackTolerance}, kAllowedFp32{1e-3, 1e-4, 1e-4};

void expect_same(const Told& told, const Told& reference, const Allowed& allowed) {
  ASSERT_EQ(told.destroyed.size(), reference.destroyed.size());
  std::vector<std::uint8_t> out(reference.stress.size(), 0);
  for (std::size_t i = 0; i < told.destroyed.size(); ++i) {
    const DestroyedElement &a = told.destroyed[i], &b = reference.destroyed[i];
    ASSERT_EQ(a.element, b.element) << "fracture " << i;
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.event, b.event);
    EXPECT_EQ(a.cause, b.cause);
    EXPECT_EQ(a.crack, b.crack);
    ASSERT_EQ(a.ratio.has_value(), b.ratio.has_value());
    if (a.ratio) {
      EXPECT_NEAR(*a.ratio, *b.ratio, allowed.ratio * *b.ratio);
    }
    out[static_cast<std::size_t>(a.element)] = 1;
  }
  ASSERT_EQ(told.cracks.size(), reference.cracks.size());
  for (std::size_t c = 0; c < told.cracks.size(); ++c) {
    EXPECT_EQ(told.cracks[c].elements, reference.cracks[c].elements);
    EXPECT_EQ(told.cracks[c].path.size(), reference.cracks[c].path.size());
    EXPECT_NEAR(told.cracks[c].length, reference.cracks[c].length, 1e-6);
  }
  ASSERT_EQ(told.steps.size(), reference.steps.size());
  for (std::size_t s = 0; s < told.steps.size(); ++s) {
    EXPECT_EQ(told.steps[s].events, reference.steps[s].events);
    EXPECT_EQ(told.steps[s].destroyed, reference.steps[s].destroyed);
    EXPECT_NEAR(told.steps[s].compliance, reference.steps[s].compliance,
                allowed.compliance * reference.steps[s].compliance);
  }
  // The CPU's, once it has taken over.
  const double of_stress = told.backend.backend == "cpu" ? kCrackTolerance : allowed.stress;
  EXPECT_TRUE(stress_error(out, told.stress, reference.stress) <= of_stress);
}

/// Large rotations are estimates on a device (docs/vulkan.md "Deformation"): their figure is left
/// out.
std::vector<std::string> without_rotation(std::vector<std::string> warnings) {
  for (std::string& text : warnings) {
    if (text.find("turned live tissue by over") != std::string::npos)
      text.erase(text.find(" (most"));
  }
  return warnings;
}

/// The reference's, and where the device was lost that it was.
void expect_warned(const Told& told, const Told& reference) {
  std::vector<std::string> others;
  for (const std::string& text : told.warnings) {
    if (text.find("backend vulkan failed in mid-run, cpu took over from the last frame: the Vulkan "
                  "device was lost") == std::string::npos) {
      others.push_back(text);
    }
  }
  EXPECT_EQ(without_rotation(others), without_rotation(reference.warnings));
  EXPECT_EQ(told.warnings.size() - others.size(), told.backend.backend == "cpu" ? 1u : 0u);
}

struct Lost {
  const char* name;
  FractureModel model;
  Route route;
  Update update;
  int steps = 4, max_events = 6;
  gpu::Variant variant = gpu::Variant::lvp;
  Precision precision = Precision::fp64;
  bool in_wait = false;  ///< reported by the wait for a submit that the device took
};

class DeviceLostLive : public WithVulkan<testing::Test> {};
class DeviceLost : public WithVulkan<testing::TestWithParam<Lost>> {};

TEST_P(DeviceLost, LosesNothingWheneverItHappens) {
  Scene scene = torn_board(GetParam().model, GetParam().steps, GetParam().max_events);
  scene.solver.backend = "cpu";
  const auto on_cpu = std::make_shared<const Problem>(scene);
  const auto create_cpu = [&] { return cpu_reference::create(on_cpu, needs_of(*on_cpu)); };
  const Told reference = tell(on_cpu, create_cpu());
  ASSERT_GE(reference.destroyed.size(), 4u);
  const bool fp32 = GetParam().precision == Precision::fp32;
  WatchedBackend watched(scene, {.variant = GetParam().variant,
                                 .precision = GetParam().precision,
                                 .update = GetParam().update,
                                 .route = GetParam().route});
  watched.options.probe.lost_in_wait = GetParam().in_wait;
  int losses = 0, submits = 0;
  // Fibonacci's distances, until a run ends before its device is lost; a sanitizer, under which a
  // run takes ten times as long, gets every other of them.
  auto later = [next = 1](int now) mutable {
    for (int i = 0; i < (validated() ? 1 : 2); ++i) {
      std::swap(now, next);
      next += now;
    }
    return now;
  };
  for (; submits < 100000; submits = later(submits)) {
    watched.options.probe.submits_until_lost = submits;
    std::unique_ptr<Backend> primary;
    try {
      primary = watched.create();
    } catch (const sunder::DeviceLost&) {
      continue;  // while it was being created: create_backend tells the caller
    }
    SCOPED_TRACE("lost after " + std::to_string(submits) + " submits");
    const Told told =
        tell(watched.problem, with_failover(watched.problem, std::move(primary), create_cpu));
    expect_same(told, reference, fp32 ? kAllowedFp32 : kAllowedFp64);
    expect_warned(told, reference);
    if (told.backend.backend == "vulkan") break;
    EXPECT_EQ(told.backend.backend, "cpu");
    EXPECT_NE(told.backend.why.find("device was lost"), std::string::npos) << told.backend.why;
    ++losses;
  }
  EXPECT_GE(losses, validated() ? 5 : 2);
}

/// What a host does to a live body, and what it and a haptic thread are told of it.
struct Handled {
  Handled(const std::shared_ptr<const Problem>& problem, std::unique_ptr<Backend> backend)
      : simulation(problem, std::move(backend)) {
    Simulation& s = simulation;
    const auto forces = s.grip_forces();
    s.step();
    const int left = s.grasp(Vec3(50, 25, 1.25), 3, true);
    s.pose(left, {s.centre_of(left) + Vec3(0.4, -0.2, 0.1), {0, 0, 0.02, 1}});
    s.step();
    s.remove(std::vector<Index>{900, 901});
    const int other = s.grasp(std::vector<Index>{40}),
              push = s.push(std::vector<Index>{200}, Vec3(0, -1, 0));
    s.step();
    s.drop(push);
    s.release(left);
    s.pose(other, {s.centre_of(other) + Vec3(0.1, 0, 0)});
    s.step();
    force = s.wrench(other).force;
    sunder::Hand hand;
    hand.grip = other;
    hand.position = s.centre_of(other);
    felt = forces->feel({}, {}, {&hand, 1});
    haptic = hand.force;
    displacement = s.displacement();
  }
  Simulation simulation;
  Vec3 force = Vec3::Zero(), haptic = Vec3::Zero();
  Felt felt;
  std::vector<Vec3> displacement;
};

TEST_F(DeviceLostLive, GripsPushesAndRemovalsGoOn) {
  Scene scene = torn_board(FractureModel::none, 8, 6);
  scene.live = true;
  scene.solver.backend = "cpu";
  const auto on_cpu = std::make_shared<const Problem>(scene);
  const auto create_cpu = [&] { return cpu_reference::create(on_cpu, needs_of(*on_cpu)); };
  const Handled reference(on_cpu, create_cpu());
  ASSERT_GT(reference.force.norm(), 1e-3);
  WatchedBackend watched(
      scene, {.precision = Precision::fp64, .update = Update::deferred, .route = Route::inverse});
  int losses = 0;
  for (int submits = 1; submits < 100000; submits += submits / 2 + 1) {
    watched.options.probe.submits_until_lost = submits;
    std::unique_ptr<Backend> primary;
    try {
      primary = watched.create();
    } catch (const sunder::DeviceLost&) {
      continue;
    }
    SCOPED_TRACE("lost after " + std::to_string(submits) + " submits");
    const Handled told(watched.problem,
                       with_failover(watched.problem, std::move(primary), create_cpu));
    double most = 0, largest = 0;
    for (std::size_t n = 0; n < told.displacement.size(); ++n) {
      most = std::max(most, (told.displacement[n] - reference.displacement[n]).norm());
      largest = std::max(largest, reference.displacement[n].norm());
    }
    EXPECT_LE(most, 1e-6 * largest);
    EXPECT_LE((told.force - reference.force).norm(), 1e-5 * reference.force.norm());
    EXPECT_EQ(told.felt.state, FeltState::live);
    EXPECT_LE((told.haptic - told.force).norm(), 1e-5 * reference.force.norm());
    if (told.simulation.backend().info().backend == "vulkan") break;
    ++losses;
  }
  EXPECT_GE(losses, 2);
}

INSTANTIATE_TEST_SUITE_P(
    All, DeviceLost,
    testing::Values(Lost{"A_deferred", FractureModel::a, Route::inverse, Update::deferred},
                    Lost{"B_deferred", FractureModel::b, Route::inverse, Update::deferred},
                    Lost{"B_eager", FractureModel::b, Route::inverse, Update::eager},
                    Lost{"A_cg", FractureModel::a, Route::cg, Update::automatic, 2, 2},
                    Lost{"A_gpu_in_wait", FractureModel::a, Route::inverse, Update::deferred, 4, 6,
                         gpu::Variant::gpu, Precision::fp64, true},
                    Lost{"A_fp32_in_wait", FractureModel::a, Route::inverse, Update::deferred, 4, 6,
                         gpu::Variant::lvp, Precision::fp32, true},
                    Lost{"B_gpu_fp32", FractureModel::b, Route::inverse, Update::deferred, 4, 6,
                         gpu::Variant::gpu, Precision::fp32, false},
                    Lost{"B_gpu_eager_in_wait", FractureModel::b, Route::inverse, Update::eager, 4,
                         6, gpu::Variant::gpu, Precision::fp64, true},
                    Lost{"A_gpu_cg_in_wait", FractureModel::a, Route::cg, Update::automatic, 2, 2,
                         gpu::Variant::gpu, Precision::fp64, true}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace sunder::test
