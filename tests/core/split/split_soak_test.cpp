// SPDX-License-Identifier: Apache-2.0
// Long cracks: two hundred steps against a fresh factor of the split mesh, over new bases; ten
// thousand random steps through random meshes.
#include <numeric>
#include <random>

#include "split_against_fresh.hpp"

namespace sunder {
namespace {

class LongCracks : public ::testing::TestWithParam<Route> {};

INSTANTIATE_TEST_SUITE_P(All, LongCracks, ::testing::Values(Route::inverse, Route::factor),
                         [](const ::testing::TestParamInfo<Route>& of) {
                           return of.param == Route::inverse ? "inverse" : "factor";
                         });

TEST_P(LongCracks, TwoHundredStepsAreAsAFreshFactorSays) {
  const test::SplitCase c{GetParam(), false, 0.3, false};
  std::mt19937 random(7);
  const auto problem = std::make_shared<const Problem>(
      scene_of(c, test::shaken_board({210, 6, 2, 210, 6, 2}, random, 0.2)));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  const auto force =
      test::shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, test::kBy);
  test::EdgeSplit crack(*problem);
  backend->change(crack.begin(0).change);
  for (int i = 1; i <= 200; ++i) {
    auto step = crack.advance(0);
    ASSERT_TRUE(step.moved() && !step.through) << i;
    step.change.held = true;  // it hangs together before it runs through
    backend->change(step.change);
    backend->set_load(test::load_of(*problem, force, {}));
    EXPECT_LE(backend->solve().error, 1e-8) << i;
    static_cast<void>(backend->stress());
    if (i == 10 || i == 50 || i == 100 || i == 200) expect_as_fresh(crack, c, *backend, force);
  }
}

/// All that can be read of it: at every node, those that have come too, and element.
struct Read {
  explicit Read(const Backend& backend)
      : u(static_cast<std::size_t>(backend.node_count())),
        stress(static_cast<std::size_t>(backend.problem().tet_count())) {
    std::vector<Index> nodes(u.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    backend.read_displacement(nodes, u);
    backend.read_stress(stress);
  }
  bool operator==(const Read&) const = default;
  std::vector<Vec3> u;
  std::vector<Voigt> stress;
};

// Over new bases, which states hold on to. What is solved again has the same bits too.
TEST_P(LongCracks, TwoHundredStepsAreTakenBackBitForBit) {
  const test::SplitCase c{GetParam(), false, 0.3, false};
  std::mt19937 random(7);
  const auto problem = std::make_shared<const Problem>(
      scene_of(c, test::shaken_board({210, 6, 2, 210, 6, 2}, random, 0.2)));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  const auto force =
      test::shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, test::kBy);
  test::EdgeSplit crack(*problem);
  std::vector<fem::Change> changes{crack.begin(0).change};
  for (int i = 1; i <= 200; ++i) {
    changes.push_back(crack.advance(0).change);
    changes.back().held = true;
  }
  std::vector<std::shared_ptr<const BackendState>> states;
  std::vector<Read> read;
  const auto look = [&] {
    backend->set_load(test::load_of(*problem, force, {}));
    static_cast<void>(backend->solve());
    static_cast<void>(backend->stress());
    return Read(*backend);
  };
  const auto go_on_from = [&](std::size_t at) {
    for (std::size_t i = at; i <= changes.size(); ++i) {
      if (i > 0) backend->change(changes[i - 1]);
      const Read now = look();
      if (i < read.size()) {
        ASSERT_TRUE(now == read[i]) << i << " steps, again";
        continue;
      }
      read.push_back(now);
      states.push_back(backend->save());
      ASSERT_TRUE(states.back()) << i;
    }
  };
  go_on_from(0);
  EXPECT_TRUE(std::ranges::any_of(backend->buffers(), [](const BufferPlan& b) {
    return b.name.starts_with("damaged factor");
  })) << "no new base on the way";
  std::size_t at = changes.size();
  for (const std::size_t by : {1, 10, 50, 100}) {
    at -= by;
    ASSERT_TRUE(backend->restore(*states[at]));
    EXPECT_TRUE(Read(*backend) == read[at]) << at << " steps";
    EXPECT_TRUE(look() == read[at]) << at << " steps, solved again";
  }
  ASSERT_TRUE(backend->restore(*states[0]));
  EXPECT_TRUE(Read(*backend) == read[0]);
  go_on_from(1);
}

TEST(LongCracks, TenThousandRandomStepsNeverFail) {
  std::mt19937 random(20261125);
  std::uniform_real_distribution<double> kink(-70 * EIGEN_PI / 180, 70 * EIGEN_PI / 180);
  int advances = 0;
  for (int run = 0; advances < 10000; ++run) {
    const Index nz = 1 + run % 3;
    const Problem problem(test::board_scene(
        test::shaken_board({24, 20, nz, 24, 20, static_cast<double>(nz)}, random, 0.25),
        FractureModel::b));
    test::EdgeSplit crack(problem);
    ASSERT_TRUE(crack.begin(kink(random) / 3).moved()) << run;
    for (int i = 0; i < 60; ++i) {
      const auto step = crack.advance(i % 3 == 0 ? kink(random) : kink(random) / 5);
      ++advances;
      if (step.through) break;
      ASSERT_TRUE(step.moved()) << run << " " << i;
    }
    for (Index e = 0; e < problem.tet_count(); ++e) {
      for (std::size_t a = 0; a < 4; ++a) {
        ASSERT_EQ(crack.body.in_mesh(crack.body.corners(e)[a]), problem.mesh().tets[e][a]);
      }
    }
    // What it cuts off, at the rim or where it has met itself, is never a crumb.
    for (const auto& [first, size] : crack.piece_sizes()) ASSERT_GE(size, 12) << run;
  }
}

}  // namespace
}  // namespace sunder
