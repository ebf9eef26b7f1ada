// SPDX-License-Identifier: Apache-2.0
// New bases: none in a frame up to the damage at which one is cheaper, told beyond it.
#include <gtest/gtest.h>

#include "core/frame/live_world.hpp"

namespace sunder::test {
namespace {

const std::vector<LiveWay> kDeferred{
    {"inverse", Route::inverse}, {"factor", Route::factor}, {"condensed", Route::condensed}};

class NewBasesOf : public testing::TestWithParam<LiveWay> {};

// Cut, removal and grip: the small matrix takes them all.
TEST_P(NewBasesOf, AreNoneForWhatIsCheaperWithout) {
  LiveRun run(live_strip(GetParam()));
  Simulation& s = run.simulation;
  EXPECT_EQ(s.step().new_bases.count, 0) << "that of the start is none";
  const int grip = s.grasp(kLeft, true);
  EXPECT_EQ(s.step().new_bases.count, 0);
  s.remove(std::vector<Index>{100, 101});
  EXPECT_EQ(s.step().new_bases.count, 0);
  const Vec3 a(2.1, 5.1, -1), b(2.1, 5.1, 2), c(2.3, 5.1, -1), d(2.3, 5.1, 2);
  EXPECT_GT(s.cut(std::vector<std::array<Vec3, 3>>{{a, b, c}, {b, d, c}}), 0);
  s.release(grip);
  const StepReport last = s.step();
  EXPECT_EQ(last.new_bases.count, 0);
  EXPECT_EQ(last.new_bases.waited_ms, 0);
  run.expect_fresh(kCrackTolerance);
}

// One element after the other, until the damage has gathered so many columns that a base comes.
TEST_P(NewBasesOf, AreToldWhereDamageHasGathered) {
  Scene scene = live_strip(GetParam());
  scene.mesh = structured_board({12, 24, 1, 4, 8, 1});
  LiveRun run(std::move(scene));
  Simulation& s = run.simulation;
  s.step();
  int told = 0, removed = 0;
  double waited = 0;
  for (Index e = 0; e < run.problem->tet_count() && told == 0; e += 5, ++removed) {
    s.remove(std::vector<Index>{e});
    const NewBases news = s.step().new_bases;
    told += news.count;
    waited += news.waited_ms;
  }
  EXPECT_EQ(told, 1);
  EXPECT_EQ(s.step().new_bases.count, 0) << "told once";
  EXPECT_GT(removed, 40);
  EXPECT_GE(waited, 0);
  run.expect_fresh(kCutTolerance);
}

INSTANTIATE_TEST_SUITE_P(Ways, NewBasesOf, testing::ValuesIn(kDeferred),
                         [](const auto& of) { return std::string(of.param.name); });

// So many elements at once that a new factor costs less than their update: in the call, by remove
// and by cut, and told with the time that it took.
TEST(NewBases, OfManyElementsAtOnceAreMadeInTheCall) {
  for (const bool cut : {false, true}) {
    SCOPED_TRACE(cut);
    Scene scene = live_strip({"factor", Route::factor});
    scene.mesh = structured_board({12, 24, 2, 4, 8, 1});
    LiveRun run(std::move(scene));
    Simulation& s = run.simulation;
    s.step();
    if (cut) {
      std::vector<std::array<Vec3, 3>> swept;
      for (const double y : {3.4, 4.1, 4.8}) {
        const Vec3 a(-1, y, -1), b(-1, y, 2), c(3.6, y, -1), d(3.6, y, 2);
        swept.insert(swept.end(), {{a, b, c}, {b, d, c}});
      }
      EXPECT_GT(s.cut(swept), 100);
    } else {
      std::vector<Index> many;
      for (Index e = 0; e < 3 * 400; e += 3) many.push_back(e);
      s.remove(many);
    }
    const NewBases news = s.step().new_bases;
    EXPECT_GE(news.count, 1);
    EXPECT_GT(news.waited_ms, 0);
    EXPECT_EQ(s.step().new_bases.count, 0);
    run.expect_fresh(kCutTolerance);
  }
}

// By the laws of finite deformation a grip that the base holds by itself takes a new one to let go.
TEST(NewBases, OfALawOfFiniteDeformationAreTold) {
  Scene scene = live_strip({"factor", Route::factor});
  scene.instruments[0].action = Pull{band(-1, 0.1), Vec3(0, -0.3, 0)};
  scene.materials["board"].law = MaterialLaw::corotated;
  Instrument held;
  held.action = Grip{std::vector<Index>(kLeft), Vec3(-0.1, 0, 0), Axes{7}};
  scene.instruments.push_back(held);
  LiveRun run(std::move(scene));
  Simulation& s = run.simulation;
  for (int i = 0; i < 3; ++i) s.step();
  s.release(1);
  const NewBases news = s.step().new_bases;
  EXPECT_GE(news.count, 1);
  EXPECT_GT(news.waited_ms, 0);
}

}  // namespace
}  // namespace sunder::test
