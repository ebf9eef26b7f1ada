// SPDX-License-Identifier: Apache-2.0
// Finite numbers of any size from a host: a frame is whole and finite or refused, and what a body
// does later does not remember it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/frame/live_laws.hpp"
#include "core/frame/run_state.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

constexpr double kWild[] = {1e30, 1e153, 1e154, 1e300, std::numeric_limits<double>::max(), 5e-324};

struct WildAction {
  const char* name;
  std::function<void(Simulation&, double)> act;
};

const std::vector<WildAction> kActions{
    {"push", [](Simulation& s, double wild) { s.push(kRight, Vec3(wild, 0, -wild)); }},
    {"drive", [](Simulation& s, double wild) { s.drive(0, Vec3(0, wild, 0)); }},
    {"pose",
     [](Simulation& s, double wild) {
       const int grip = s.grasp(kRight, true);
       s.pose(grip, {s.centre_of(grip) + Vec3(wild, wild, 0), {0, 0, 0, 1}});
     }},
    {"turn",
     [](Simulation& s, double wild) {
       const int grip = s.grasp(kRight, true);
       s.pose(grip, {s.centre_of(grip), {wild, 0, 0, wild}});
     }},
    {"cut",
     [](Simulation& s, double wild) {
       const std::array<Vec3, 3> blade{Vec3(-wild, -wild, 0), Vec3(wild, -wild, 0),
                                       Vec3(0, wild, 0)};
       s.cut({&blade, 1});
     }},
};

void expect_finite(const Simulation& s) {
  for (const Vec3& u : s.displacement()) ASSERT_TRUE(u.allFinite());
  for (const Voigt& stress : s.stress()) ASSERT_TRUE(stress.allFinite());
}

/// Each action with each number on a body of its own; then all of it is taken back.
void handle_wildly(Scene scene) {
  scene.fracture.model = FractureModel::a;
  const auto problem = std::make_shared<const Problem>(scene);
  const auto make = [problem] { return cpu_reference::create(problem, needs_of(*problem)); };
  LiveRun untouched(problem, make);
  untouched.simulation.step();
  untouched.simulation.step();
  for (const WildAction& action : kActions) {
    for (const double wild : kWild) {
      SCOPED_TRACE(action.name + (" " + std::to_string(std::log10(wild))));
      LiveRun run(problem, make);
      run.keep_history();
      Simulation& s = run.simulation;
      s.step();
      const Mark before = s.save();
      bool refused = false;
      try {
        action.act(s, wild);
        for (int i = 0; i < 2; ++i) {
          s.step();
          expect_finite(s);
        }
      } catch (const Error& error) {
        refused = true;
        EXPECT_GT(std::string(error.what()).size(), 20u);
      }
      s.restore(before);
      s.step();
      expect_finite(s);
      expect_same_bits(RunState(s), RunState(untouched.simulation));
      if (testing::Test::HasFailure()) {
        ADD_FAILURE() << "the first of them" << (refused ? ", refused" : "");
        return;
      }
    }
  }
}

class WildInput : public testing::TestWithParam<LawWay> {};

TEST_P(WildInput, IsBoundedOrRefused) { handle_wildly(law_strip(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Laws, WildInput, testing::ValuesIn(kLaws),
                         [](const auto& of) { return std::string(of.param.name); });

class WildInputOfLinear : public testing::TestWithParam<LiveWay> {};

TEST_P(WildInputOfLinear, IsBoundedOrRefused) { handle_wildly(live_strip(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Ways, WildInputOfLinear, testing::ValuesIn(kLiveWays),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sunder::test
