// SPDX-License-Identifier: Apache-2.0
// What a host takes hold of on Vulkan, against the body computed anew.
#include "core/frame/live_random.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using Grasps = WithVulkan<>;

Scene strip_to_hold() { return live_strip({"vulkan", Route::automatic}); }

std::vector<Way> ways_that_grasp() {
  std::vector<Way> all;
  for (const Precision precision : {Precision::fp32, Precision::fp64}) {
    for (const Route route : {Route::inverse, Route::condensed}) {
      all.push_back({.precision = precision, .update = Update::deferred, .route = route});
    }
  }
  all.push_back({.variant = gpu::Variant::gpu, .precision = Precision::fp64});
  all.push_back({.precision = Precision::fp32, .float64 = false});
  return all;
}

double tolerance_of(const Way& way) {
  return way.precision == Precision::fp64 ? kCrackTolerance : kFp32Tolerance;
}

TEST_F(Grasps, HoldTurnAndLetGo) {
  for (const Way& way : ways_that_grasp()) {
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? " condensed" : ""));
    const WatchedBackend watched(strip_to_hold(), way);
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
}

TEST_F(Grasps, AtRandomLeadToWhatTheBodyIsAnew) {
  for (const Way& way : ways_that_grasp()) {
    if (way.variant == gpu::Variant::gpu || !way.float64) continue;  // time
    SCOPED_TRACE(name_of(way) + (way.route == Route::condensed ? " condensed" : ""));
    const WatchedBackend watched(strip_to_hold(), way);
    const Played played = play_at_random(
        watched.problem, [&] { return watched.create(); }, 11, 120, 10, 8, tolerance_of(way));
    EXPECT_GE(played.checked, 8);
    EXPECT_GE(played.grasped, 2);
  }
}

TEST_F(Grasps, AreRefusedWhereTheyCannotBe) {
  for (const auto& [route, update] :
       {std::pair{Route::cg, Update::automatic}, {Route::inverse, Update::eager}}) {
    const WatchedBackend watched(strip_to_hold(), {.update = update, .route = route});
    LiveRun run(watched.problem, [&] { return watched.create(); });
    try {
      static_cast<void>(run.simulation.grasp(kLeft));
      ADD_FAILURE();
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("backend cpu"), std::string::npos) << error.what();
    }
    run.simulation.step();
  }
}

TEST_F(Grasps, ByALawOfFiniteDeformationAndInMotion) {
  for (const bool moves : {false, true}) {
    SCOPED_TRACE(moves);
    Scene scene = strip_to_hold();
    scene.materials["board"].law = MaterialLaw::corotated;
    scene.materials["board"].density = 1e-9;
    scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -0.3, 0)};
    if (moves) scene.dynamics = Dynamics{.time_step = 2e-4, .mass_damping = 500};
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
