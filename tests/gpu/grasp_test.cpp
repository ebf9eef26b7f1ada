// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of on Vulkan, against the body computed anew.
#include "core/frame/live_laws.hpp"
#include "core/frame/live_random.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using Grasps = WithVulkan<>;

Scene strip_to_hold() { return live_strip({"vulkan", Route::automatic}); }

/// On route condensed also what a host does beyond the region.
std::vector<Scene> strips_to_hold(const Way& way) {
  std::vector<Scene> all{strip_to_hold()};
  if (way.route == Route::condensed) {
    all.push_back(live_strip({"patch", Route::automatic, Update::automatic, true}));
  }
  return all;
}

std::vector<Way> ways_that_grasp() {
  std::vector<Way> all;
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    for (const Route route : {Route::inverse, Route::condensed}) {
      all.push_back({.precision = precision, .update = Update::deferred, .route = route});
    }
  }
  all.push_back({.variant = gpu::Variant::gpu, .precision = Precision::fp64});
  all.push_back({.precision = Precision::fp32, .float64 = false});
  Way cg{.precision = Precision::fp64, .update = Update::automatic, .route = Route::cg};
  all.push_back(cg);
  cg.variant = gpu::Variant::gpu;
  all.push_back(cg);
  return all;
}

double tolerance_of(const Way& way) {
  return way.precision == Precision::fp64 ? kCrackTolerance : kFp32Tolerance;
}

void hold_turn_and_let_go(const WatchedBackend& watched, const Way& way) {
  LiveRun run(watched.problem, [&] { return watched.create(); });
  Simulation& s = run.simulation;
  s.step();
  const int left = s.grasp(kLeft, true);
  EXPECT_EQ(s.wrench(left).force, Vec3::Zero());
  s.pose(left, {s.centre_of(left) + Vec3(-0.1, 0.05, 0), {0, 0, 0.1, 1}});
  s.step();
  run.expect_fresh(tolerance_of(way));
  s.remove(std::vector<Index>{70, 71, 100});
  run.expect_fresh(tolerance_of(way));
  const int right = s.grasp(kRight);
  run.push(kLow, Vec3(0.1, 0, 0.1));
  s.pose(right, {s.centre_of(right) + Vec3(0.1, 0.1, 0.02)});
  s.step();
  run.expect_fresh(tolerance_of(way));
  const Wrench felt = s.wrench(right), anew = run.fresh().wrench(kRight, s.centre_of(right));
  EXPECT_LE((felt.force - anew.force).norm(), 10 * tolerance_of(way) * (1 + anew.force.norm()));
  s.release(left);
  s.remove(std::vector<Index>{101});
  s.step();
  run.expect_fresh(tolerance_of(way));
  s.release(right);
  s.step();
  run.expect_fresh(tolerance_of(way));
}

TEST_F(Grasps, HoldTurnAndLetGo) {
  for (const Way& way : ways_that_grasp()) {
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? " condensed" : ""));
    for (const Scene& scene : strips_to_hold(way)) {
      const WatchedBackend watched(scene, way);
      hold_turn_and_let_go(watched, way);
    }
  }
}

// A grip of the scene lets go: the body is that of a scene without it.
TEST_F(Grasps, OfTheSceneLetGo) {
  Scene held = strip_to_hold();
  Instrument forceps;
  Grip grip{std::vector<Index>(kLeft), Vec3(-0.1, 0.05, 0.02), Axes{7}};
  grip.rigid = true;
  forceps.action = grip;
  held.instruments.push_back(forceps);
  forceps.action = Grip{std::vector<Index>(kRight), Vec3(0.1, 0, 0), Axes{7}};
  held.instruments.push_back(forceps);
  for (const Way& way : ways_that_grasp()) {
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? " condensed" : ""));
    const WatchedBackend watched(held, way);
    LiveRun run(watched.problem, [&] { return watched.create(); }), never(strip_to_hold());
    Simulation& s = run.simulation;
    s.step();
    s.remove(std::vector<Index>{70, 71});
    s.step();
    EXPECT_GT(s.reactions()[1].norm(), 0.01);
    s.release(1);
    s.step();
    run.expect_fresh(tolerance_of(way));
    EXPECT_EQ(s.reactions()[1], Vec3::Zero());
    s.remove(std::vector<Index>{100});
    s.release(2);
    s.step();
    run.expect_fresh(tolerance_of(way));
    never.simulation.remove(std::vector<Index>{70, 71, 100});
    never.simulation.step();
    const auto u = s.displacement(), v = never.simulation.displacement();
    double most = 0, largest = 0;
    for (std::size_t n = 0; n < u.size(); ++n) {
      most = std::max(most, (u[n] - v[n]).norm());
      largest = std::max(largest, v[n].norm());
    }
    EXPECT_LE(most, tolerance_of(way) * largest);
    const int again = s.grasp(kLeft);
    s.pose(again, {s.centre_of(again) + Vec3(0.1, 0, 0)});
    s.step();
    run.expect_fresh(tolerance_of(way));
  }
}

// In motion and by a law of finite deformation as on the CPU.
TEST_F(Grasps, OfTheSceneLetGoByOtherLaws) {
  for (const bool moves : {false, true}) {
    SCOPED_TRACE(moves);
    Scene scene = law_strip({"vulkan", MaterialLaw::corotated, Route::automatic, moves});
    Instrument forceps;
    forceps.action = Grip{std::vector<Index>(kLeft), Vec3(-0.1, 0, 0), Axes{7}};
    scene.instruments.push_back(forceps);
    LiveRun cpu(scene);
    const WatchedBackend watched(scene, {.route = Route::automatic});
    LiveRun gpu(watched.problem, [&] { return watched.create(); });
    for (LiveRun* run : {&cpu, &gpu}) {
      for (int i = 0; i < 4; ++i) run->simulation.step();
      run->simulation.remove(std::vector<Index>{100, 101});
      run->simulation.step();
      run->simulation.release(1);
      for (int i = 0; i < 6; ++i) run->simulation.step();
    }
    const auto a = cpu.simulation.displacement(), b = gpu.simulation.displacement();
    double most = 0, largest = 0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      most = std::max(most, (a[n] - b[n]).norm());
      largest = std::max(largest, a[n].norm());
    }
    EXPECT_LE(most, 1e-3 * largest);
  }
}

TEST_F(Grasps, AtRandomLeadToWhatTheBodyIsAnew) {
  for (const Way& way : ways_that_grasp()) {
    if (way.variant == gpu::Variant::gpu || !way.float64) continue;  // time
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? " condensed" : ""));
    for (const Scene& scene : strips_to_hold(way)) {
      const WatchedBackend watched(scene, way);
      const Played played = play_at_random(
          watched.problem, [&] { return watched.create(); }, 11, 120, 10, 8, tolerance_of(way));
      EXPECT_GE(played.checked, 8);
      EXPECT_GE(played.grasped, 2);
    }
  }
}

TEST_F(Grasps, AreRefusedWhereTheyCannotBe) {
  const WatchedBackend watched(strip_to_hold(), {.update = Update::eager, .route = Route::inverse});
  LiveRun run(watched.problem, [&] { return watched.create(); });
  try {
    static_cast<void>(run.simulation.grasp(kLeft));
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("backend cpu"), std::string::npos) << error.what();
  }
  run.simulation.step();
}

TEST_F(Grasps, ByALawOfFiniteDeformationAndInMotion) {
  for (const bool moves : {false, true}) {
    SCOPED_TRACE(moves);
    Scene scene = law_strip({"vulkan", MaterialLaw::corotated, Route::automatic, moves});
    LiveRun cpu(scene);
    const WatchedBackend watched(scene, {.route = Route::automatic});
    LiveRun gpu(watched.problem, [&] { return watched.create(); });
    for (LiveRun* run : {&cpu, &gpu}) {
      Simulation& s = run->simulation;
      s.step();
      const int grip = s.grasp(kLeft, true);
      s.pose(grip, {s.centre_of(grip) + Vec3(-0.1, 0, 0), {0, 0, 0.05, 1}});
      for (int i = 0; i < 4; ++i) s.step();
      s.remove(std::vector<Index>{100, 101});
      for (int i = 0; i < 4; ++i) s.step();
      s.release(grip);
      for (int i = 0; i < 4; ++i) s.step();
    }
    const auto a = cpu.simulation.displacement(), b = gpu.simulation.displacement();
    double most = 0, largest = 0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      most = std::max(most, (a[n] - b[n]).norm());
      largest = std::max(largest, a[n].norm());
    }
    EXPECT_LE(most, 1e-3 * largest);
  }
}

}  // namespace
}  // namespace sunder::test
