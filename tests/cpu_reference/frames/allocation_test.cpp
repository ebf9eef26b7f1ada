// SPDX-License-Identifier: Apache-2.0
// A frame allocates nothing once it is warm. Frames on bases that are taken later, and under a load
// that turns: allocation_tear_test.cpp.
#include <gtest/gtest.h>

#include "cpu_reference/frames/allocation_count.hpp"
#include "cpu_reference/frames/allocation_ways.hpp"
#include "sunder/simulation.hpp"
#include "support/body.hpp"
#include "support/notch_board.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

TEST(Count, SeesEveryWayToAllocate) {
  const Count counted;
  long before = counted.sum();
  const auto one_more = [&](const char* what) {
    EXPECT_GT(counted.sum(), before) << what;
    before = counted.sum();
  };
  void* volatile plain = std::malloc(10);  // an unused one may be left out
  std::free(plain);
  one_more("malloc");
  double* volatile kept = new double(1);
  delete kept;
  one_more("operator new");
  { const std::vector<double> v(3); }
  one_more("a vector");
  { const Eigen::VectorXd v = Eigen::VectorXd::Zero(7); }
  one_more("Eigen");
  void* p = nullptr;
  EXPECT_EQ(posix_memalign(&p, 64, 128), 0);
  std::free(p);
  one_more("posix_memalign");
}

class Allocations : public ::testing::TestWithParam<Way> {};

// The backend's frame: update, load, solution with its check, stress with its summary. What the
// thread of a new base allocates is not counted: no frame waits for it.
TEST_P(Allocations, AreNoneInAWarmFrame) {
  Scene scene = pulled_board();
  scene.solver.route = GetParam().route;
  scene.solver.update = GetParam().update;
  const Body body(std::move(scene));
  std::vector<double> force(body.problem->dofs().size(), 0.0);
  for (Index n = 0; n < body.problem->node_count(); ++n) {
    if (body.problem->mesh().nodes[n].x() > 49.9) force[3 * static_cast<std::size_t>(n)] = 0.5;
  }
  Load load = load_of(*body.problem, force, {});
  body.backend->set_load(load);
  const auto sequence = crack_sequence(*body.problem, 40, 8);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    for (double& f : load.forces) f *= 1.01;
    const Count counted;
    body.backend->destroy({&sequence[i], 1});
    body.backend->set_load(load);
    body.backend->solve();
    body.backend->stress();
    const long warm = i < 10 ? 0 : counted.sum();
    EXPECT_EQ(warm, 0) << "fracture " << i;
  }
  for (int quiet = 0; quiet < 5; ++quiet) {
    const Count counted;
    body.backend->set_load(load);
    body.backend->solve();
    body.backend->stress();
    EXPECT_EQ(counted.sum(), 0) << "quiet frame " << quiet;
  }
}

// All of a step: instruments, frame, decision, report, preparation. Nothing breaks.
TEST_P(Allocations, AreNoneInAWarmQuietStep) {
  Scene scene = pulled_board(Vec3(0, -0.01, 0));
  Instrument grip;
  grip.name = "grip";
  grip.action =
      Grip{Box{Vec3(-0.001, -0.001, -1), Vec3(0.001, 0.001, 3)}, Vec3::Constant(1e-4), Axes{7}};
  scene.instruments.push_back(grip);
  scene.fracture.model = FractureModel::b;
  scene.solver.route = GetParam().route;
  scene.solver.update = GetParam().update;
  scene.steps = 20;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation.done()) {
    const Count counted;
    const StepReport report = simulation.step();
    const long sum = counted.sum();
    ASSERT_EQ(report.destroyed, 0);
    EXPECT_EQ(report.step < 5 ? 0 : sum, 0) << "step " << report.step;
  }
}

// Warmed up, the first step allocates nothing, as the second does.
TEST_P(Allocations, AreNoneInTheFirstStepAfterAWarmUp) {
  Scene scene = pulled_board(Vec3(0, -0.01, 0));
  scene.fracture.model = FractureModel::a;
  scene.solver.route = GetParam().route;
  scene.solver.update = GetParam().update;
  scene.solver.prepare = false;  // a prepared fracture's room comes with the first of them
  scene.steps = 20;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  simulation.warm_up();
  for (int step = 0; step < 2; ++step) {
    const Count counted;
    simulation.step();
    EXPECT_EQ(counted.sum(), 0) << step;
  }
}

struct Tear {
  const char* name;
  Route route;
  FractureModel model = FractureModel::b;
  SifSource sif = SifSource::formula;
  CrackBirth birth = CrackBirth::element;
  Update update = Update::deferred;
};

Scene notch(const Tear& tear) {
  Scene scene = notch_board(tear.model);
  scene.solver.route = tear.route;
  scene.solver.update = tear.update;
  scene.fracture.sif = tear.sif;
  scene.fracture.birth = tear.birth;
  scene.steps = 60;
  return scene;
}

class Cascade : public ::testing::TestWithParam<Tear> {};

// All of a step with a crack open, quiet or tearing: the notch grows, new cracks are born beside
// it, up to 28 of them, by up to 170 elements in a step; new bases begin. The first step takes the
// notch out and is the warm-up.
TEST_P(Cascade, AllocatesNothingOnceItIsWarm) {
  constexpr int kMost = 200;  // elements; the next step would tear the board in two
  const auto problem = std::make_shared<const Problem>(notch(GetParam()));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  int before = simulation.step().destroyed, tearing = 0;
  while (!simulation.done() && before <= kMost) {
    const Count counted;
    const StepReport report = simulation.step();
    const long sum = counted.sum();
    const int destroyed = report.destroyed - before;
    before = report.destroyed;
    tearing += destroyed > 0;
    EXPECT_EQ(sum, 0) << "step " << report.step << ", " << destroyed << " elements";
  }
  EXPECT_GT(tearing, 0);
}

Tear eager(Tear tear) {
  tear.update = Update::eager;
  return tear;
}

INSTANTIATE_TEST_SUITE_P(
    Notch, Cascade,
    ::testing::Values(
        Tear{"Inverse", Route::inverse}, Tear{"Condensed", Route::condensed},
        Tear{"Factor", Route::factor},
        Tear{"InverseByField", Route::inverse, FractureModel::b, SifSource::field},
        Tear{"CondensedByField", Route::condensed, FractureModel::b, SifSource::field},
        Tear{"FactorByField", Route::factor, FractureModel::b, SifSource::field},
        Tear{"InverseByShear", Route::inverse, FractureModel::a},
        Tear{"CondensedByShear", Route::condensed, FractureModel::a},
        Tear{"FactorByShear", Route::factor, FractureModel::a},
        Tear{"BirthThrough", Route::inverse, FractureModel::b, SifSource::formula,
             CrackBirth::through},
        eager(Tear{"InverseEager", Route::inverse}),
        eager(Tear{"InverseEagerByField", Route::inverse, FractureModel::b, SifSource::field}),
        eager(Tear{"InverseEagerByShear", Route::inverse, FractureModel::a})),
    [](const auto& p) { return p.param.name; });

INSTANTIATE_TEST_SUITE_P(Routes, Allocations, every_way(),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace sunder::test
