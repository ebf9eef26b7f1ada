// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "sunder/error.hpp"
#include "support/body.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

/// A board of some cells, held at its left end.
Scene board(Index nx, Index ny) {
  Scene scene;
  scene.mesh = structured_board({nx, ny, 1, 10, 10, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(0.001, 11, 2)}, Axes{7}});
  scene.solver.backend = "cpu";
  return scene;
}

BackendInfo info_of(Scene scene, Needs needs = all_needs()) {
  return Body(std::move(scene), std::move(needs)).backend->info();
}

TEST(ChooseRoute, TakesADenseInverseForASmallBodyThatTears) {
  const BackendInfo info = info_of(board(6, 6));
  EXPECT_EQ(info.route, "inverse");
  EXPECT_EQ(info.update, "deferred");
  EXPECT_TRUE(mentions(info.why, "252 unknowns")) << info.why;
}

TEST(ChooseRoute, TakesTheFactorWhenNothingTears) {
  Needs needs;
  needs.stress = true;
  const Body body(board(6, 6), needs);
  EXPECT_EQ(body.backend->info().route, "factor");
  EXPECT_EQ(body.backend->info().update, "none");
  EXPECT_TRUE(mentions(body.backend->info().why, "nothing can be destroyed"));
  for (const BufferPlan& b : body.backend->buffers()) EXPECT_FALSE(mentions(b.name, "inverse"));
}

TEST(ChooseRoute, TakesTheFactorForALargeBody) {
  const BackendInfo info = info_of(board(40, 40));  // 2 * 41 * 40 * 3 = 9840 unknowns
  EXPECT_EQ(info.route, "factor");
  EXPECT_EQ(info.update, "deferred");
  EXPECT_TRUE(mentions(info.why, "774 MB")) << info.why;
}

/// A board of which a strip can tear, pulled at a corner.
Scene strip(Index cells, double height) {
  Scene scene;
  scene.mesh = structured_board({cells, cells, 1, 10, 10, 1}, [height](const Vec3& x) {
    return x.y() < height ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, 0.4, 2.0}}, {"organ", {5, 0.4, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 11, 2)}, Axes{7}});
  scene.solver.backend = "cpu";
  scene.fracture.model = FractureModel::a;
  return scene;
}

TEST(ChooseRoute, CondensesABodyThatTearsInASmallRegion) {
  const BackendInfo info = info_of(strip(20, 2));  // five rows of nodes of 20
  EXPECT_EQ(info.route, "condensed");
  EXPECT_TRUE(mentions(info.why, "2520 unknowns, of which 630 can break")) << info.why;
  EXPECT_TRUE(mentions(info.why, "3175 kB")) << info.why;
  EXPECT_EQ(info_of(strip(20, 3)).route, "inverse") << "seven rows are too many";
  Scene quiet = strip(20, 2);
  quiet.fracture.model = FractureModel::none;
  EXPECT_EQ(info_of(quiet).route, "inverse") << "any element may be destroyed by hand";
}

/// Gravity, say: a force on every node that moves.
Scene with_a_force_everywhere(Scene scene) {
  const Problem problem(scene);
  std::vector<Index> moving;
  for (Index n = 0; n < problem.node_count(); ++n) {
    if (problem.dof(n, 1) != kNone) moving.push_back(n);
  }
  Instrument gravity;
  gravity.name = "gravity";
  gravity.action = Pull{moving, Vec3(0, -5, 0)};
  scene.instruments.push_back(gravity);
  return scene;
}

// An inverse would be read whole in every frame; so would a condensed one, as nothing is left out.
TEST(ChooseRoute, TakesTheFactorWhereEveryNodeIsLoaded) {
  for (const Scene& light : {board(20, 20), strip(20, 2)}) {
    EXPECT_NE(info_of(light).route, "factor");
    const Scene loaded = with_a_force_everywhere(light);
    const BackendInfo chosen = info_of(loaded);
    EXPECT_EQ(chosen.route, "factor");
    EXPECT_TRUE(mentions(chosen.why, "2520 unknowns, 2520 of them loaded")) << chosen.why;
    for (Route other : {Route::inverse, Route::condensed}) {
      Scene forced = loaded;
      forced.solver.route = other;
      const BackendInfo info = info_of(forced);
      EXPECT_LE(chosen.quiet_ms, info.quiet_ms);
      EXPECT_LT(chosen.memory_bytes, info.memory_bytes / 2);
    }
  }
  // A loaded edge is no reason.
  Scene edge = board(20, 20);
  Instrument forceps;
  forceps.name = "forceps";
  forceps.action = Pull{Box{Vec3(9.9, -1, -1), Vec3(11, 11, 2)}, Vec3(1, 0, 0)};
  edge.instruments.push_back(forceps);
  EXPECT_EQ(info_of(edge).route, "inverse");
}

TEST(ChooseRoute, CanBeForced) {
  struct Pair {
    Route route;
    Update update;
    const char *name, *update_name;
  };
  for (const Pair& p : {Pair{Route::inverse, Update::eager, "inverse", "eager"},
                        Pair{Route::inverse, Update::deferred, "inverse", "deferred"},
                        Pair{Route::factor, Update::deferred, "factor", "deferred"},
                        Pair{Route::condensed, Update::deferred, "condensed", "deferred"},
                        Pair{Route::cg, Update::automatic, "cg", "matrix"},
                        Pair{Route::automatic, Update::eager, "inverse", "eager"}}) {
    Scene scene = board(4, 4);
    scene.solver.route = p.route;
    scene.solver.update = p.update;
    const BackendInfo info = info_of(std::move(scene));
    EXPECT_EQ(info.route, p.name);
    EXPECT_EQ(info.update, p.update_name);
  }
}

TEST(ChooseRoute, NamesWhatIsOfferedInsteadOfAnImpossiblePair) {
  struct Impossible {
    Route route;
    Update update;
    const char* offered;
  };
  for (const Impossible& i : {Impossible{Route::factor, Update::eager, "route inverse"},
                              Impossible{Route::condensed, Update::eager, "route inverse"},
                              Impossible{Route::cg, Update::eager, "update auto"},
                              Impossible{Route::cg, Update::deferred, "update auto"}}) {
    Scene scene = board(4, 4);
    scene.solver.route = i.route;
    scene.solver.update = i.update;
    try {
      info_of(std::move(scene));
      ADD_FAILURE() << "not refused: " << i.offered;
    } catch (const DeviceError& error) {
      EXPECT_TRUE(mentions(error.what(), i.offered)) << error.what();
    }
  }
}

TEST(ChooseRoute, RefusesAnInverseBeyondTheMemory) {
  Scene scene = board(300, 300);  // 540,000 unknowns: 2.3 TB
  scene.solver.route = Route::inverse;
  try {
    info_of(std::move(scene));
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::too_large);
    EXPECT_TRUE(mentions(error.what(), "use route factor")) << error.what();
  }
}

}  // namespace
}  // namespace sunder::test
