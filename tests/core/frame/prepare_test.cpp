// SPDX-License-Identifier: Apache-2.0
// A host says where it may soon change the body, and no bit depends on it.
#include <gtest/gtest.h>

#include <chrono>
#include <numeric>
#include <thread>

#include "core/frame/live_world.hpp"

namespace sunder::test {
namespace {

const std::vector<Index> kAcross{100, 101, 102}, kElsewhere{4, 5};

Scene by_factor() { return live_strip({"factor", Route::factor}); }

/// Prepared elements among those that have gone since.
Index predicted(const Simulation& simulation) {
  return simulation.backend().preparation().predicted;
}

class NamedByAHost : public testing::TestWithParam<LiveWay> {};

TEST_P(NamedByAHost, ChangesNoBit) {
  LiveRun named(live_strip(GetParam())), not_named(live_strip(GetParam()));
  const auto expect_same = [&] {
    ASSERT_EQ(named.simulation.displacement(), not_named.simulation.displacement());
    ASSERT_EQ(named.simulation.stress(), not_named.simulation.stress());
  };
  named.simulation.prepare(kAcross);
  for (const auto& elements : {kAcross, kElsewhere}) {
    named.simulation.step();
    not_named.simulation.step();
    expect_same();
    named.simulation.remove(elements);
    not_named.simulation.remove(elements);
    expect_same();
  }
  const int grip = named.simulation.grasp(kLeft);
  ASSERT_EQ(not_named.simulation.grasp(kLeft), grip);
  named.simulation.prepare(Vec3(0, 2, 0), 1.5);
  named.simulation.step();
  not_named.simulation.step();
  expect_same();
}

INSTANTIATE_TEST_SUITE_P(Ways, NamedByAHost, testing::ValuesIn(kLiveWays),
                         [](const auto& p) { return p.param.name; });

TEST(Prepare, IsMetOnRouteFactor) {
  LiveRun run(by_factor());
  run.simulation.step();
  run.simulation.prepare(kAcross);
  run.simulation.remove(kAcross);
  EXPECT_EQ(predicted(run.simulation), 3);
  run.simulation.remove(kElsewhere);
  EXPECT_EQ(predicted(run.simulation), 3) << "nobody had named those";
  run.simulation.prepare(std::vector<Index>{});
  run.simulation.remove(std::vector<Index>{103});
  EXPECT_EQ(predicted(run.simulation), 3) << "none is named any more";
}

TEST(Prepare, TakesTheFirstOnes) {
  LiveRun run(by_factor());
  run.simulation.step();
  std::vector<Index> all(190);
  std::iota(all.rbegin(), all.rend(), 0);
  run.simulation.prepare(all);
  run.simulation.remove(std::vector<Index>{100, 189, 189 - 127, 189 - 128});
  EXPECT_EQ(predicted(run.simulation), 3);
  run.simulation.remove(std::vector<Index>{3});
  EXPECT_EQ(predicted(run.simulation), 3);
}

// A quiet step prepares what breaks next by itself, and forgets nothing that a host has named.
TEST(Prepare, LastsBesideWhatBreaksByItself) {
  Scene scene = strip(1e9, 2, 100);
  scene.live = true;
  scene.solver.route = Route::factor;
  SceneRun run(std::move(scene));
  run.simulation.prepare(kAcross);
  run.simulation.step();
  run.simulation.step();
  run.simulation.remove(kAcross);
  EXPECT_EQ(predicted(run.simulation), 3);
}

TEST(Prepare, LastsOnAnotherWayAndBackend) {
  for (const bool renewed : {false, true}) {
    SCOPED_TRACE(renewed);
    LiveRun run(by_factor());
    run.keep_history();
    const Mark start = run.simulation.save();
    run.simulation.step();
    run.simulation.prepare(kAcross);
    if (renewed) {
      run.simulation.renew_backend();
    } else {
      run.simulation.restore(start);
    }
    run.simulation.step();
    run.simulation.remove(kAcross);
    EXPECT_EQ(predicted(run.simulation), 3);
  }
}

// Where the body is now, not where it was: a grip has moved it 3 mm.
TEST(Prepare, FindsWhatIsNearAPlaceNow) {
  Scene scene = by_factor();
  scene.instruments[0].action = Grip{band(-1, 0.1), Vec3(3, 0, 0), Axes{7}};
  LiveRun run(std::move(scene));
  constexpr double kRadius = 1.2;
  const Vec3 before(0, 0, 0), now(3, 0, 0);
  const auto within = [&](const Vec3& place) {
    const Mesh& mesh = run.problem->mesh();
    const auto u = run.simulation.displacement();
    std::vector<Index> all;
    for (Index e = 0; e < run.problem->tet_count(); ++e) {
      double least = 1e9;
      for (Index n : mesh.tets[static_cast<std::size_t>(e)]) {
        const auto i = static_cast<std::size_t>(n);
        least = std::min(least, (mesh.nodes[i] + u[i] - place).norm());
      }
      if (least <= kRadius) all.push_back(e);
    }
    return all;
  };
  const auto at_first = within(before);
  EXPECT_EQ(run.simulation.prepare(before, kRadius), static_cast<int>(at_first.size()));
  run.simulation.step();
  const auto near = within(now);
  ASSERT_GT(near.size(), 2u);
  EXPECT_NE(near, within(before));
  EXPECT_EQ(run.simulation.prepare(now, kRadius), static_cast<int>(near.size()));
  run.simulation.remove({near.data(), 1});
  EXPECT_EQ(predicted(run.simulation), 1);
  EXPECT_EQ(run.simulation.prepare(now, kRadius), static_cast<int>(near.size()) - 1)
      << "one is gone";
  EXPECT_EQ(run.simulation.prepare(Vec3(99, 99, 99), kRadius), 0);
}

// Beyond route condensed's region a thread begins with the columns.
TEST(Prepare, BeginsBeyondARegion) {
  LiveRun run(live_strip({"patch", Route::condensed, Update::automatic, true}));
  const auto kept = [&] {
    for (const BufferPlan& b : run.simulation.backend().buffers()) {
      if (b.name == "columns that the region may grow by") return true;
    }
    return false;
  };
  run.simulation.step();
  EXPECT_FALSE(kept());
  run.simulation.prepare(kAcross);
  for (int wait = 0; wait < 3000 && !kept(); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(kept());
}

TEST(Prepare, RefusesWhatIsNotThere) {
  LiveRun run(by_factor());
  run.simulation.step();
  const auto elements = [&](std::vector<Index> of) {
    return [&run, of] { run.simulation.prepare(of); };
  };
  const auto place = [&](Vec3 at, double radius) {
    return [&run, at, radius] { run.simulation.prepare(at, radius); };
  };
  const double nan = std::nan("");
  run.simulation.prepare(kAcross);
  refused(elements({192}), "element 192 cannot be prepared for");
  refused(elements({-1}), "element -1");
  refused(place(Vec3(0, nan, 0), 1), "place");
  refused(place(Vec3(0, 0, 0), 0), "radius");
  refused(place(Vec3(0, 0, 0), nan), "radius");
  run.simulation.remove(kAcross);
  EXPECT_EQ(predicted(run.simulation), 3) << "those named before are as they were";
  run.simulation.prepare(kAcross);  // gone: nothing to do

  Scene fixed = by_factor();
  fixed.live = false;
  LiveRun dead(std::move(fixed));
  refused([&] { dead.simulation.prepare(kAcross); }, "nothing can be prepared for");
  refused([&] { dead.simulation.prepare(Vec3(0, 0, 0), 1); }, "live");
}

}  // namespace
}  // namespace sunder::test
