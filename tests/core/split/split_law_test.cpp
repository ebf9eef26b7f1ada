// SPDX-License-Identifier: Apache-2.0
// Boards that a crack splits at finite deformation and in motion: at rest against Newton's method
// of the yardstick on the split mesh, in motion by what nothing but forces may change.
#include <gtest/gtest.h>

#include "body/hyperelastic.hpp"
#include "cpu_reference/plain/finite.hpp"
#include "split_against_fresh.hpp"

namespace sunder::test {
namespace {

struct LawCase {
  MaterialLaw law;
  Route route;
  bool grip;
};

std::string name_of(const ::testing::TestParamInfo<LawCase>& info) {
  const LawCase& c = info.param;
  return std::string(c.law == MaterialLaw::corotated ? "Corotated" : "NeoHookean") +
         (c.route == Route::inverse ? "Inverse" : "Factor") + (c.grip ? "Grip" : "Pull");
}

constexpr double kTolerance = 1e-8;
const Vec3 kFar(0.4, -1.2, 0.2);  // of the pull [N] or the grip [mm]

Scene scene_of(const LawCase& c, const Mesh& mesh) {
  Scene scene = scene_of(SplitCase{c.route, c.grip, 0.3, false}, mesh);
  scene.materials["board"].law = c.law;
  scene.solver.tolerance = kTolerance;
  // The crack runs between held nodes, past others that a grip holds on one axis alone: those part.
  if (c.grip) {
    const Box middle{Vec3(1.5, 3.5, -1), Vec3(3.5, 6.5, 9)};
    scene.instruments.push_back({"clamp", Grip{middle, Vec3::Zero(), Axes{4}}, {}});
  }
  return scene;
}

class SplitLaw : public ::testing::TestWithParam<LawCase> {};

INSTANTIATE_TEST_SUITE_P(All, SplitLaw,
                         ::testing::Values(LawCase{MaterialLaw::corotated, Route::factor, false},
                                           LawCase{MaterialLaw::corotated, Route::inverse, true},
                                           LawCase{MaterialLaw::neo_hookean, Route::factor, true},
                                           LawCase{MaterialLaw::neo_hookean, Route::inverse,
                                                   false}),
                         name_of);

/// Displacements of the grips, of those too that have parted.
std::vector<double> grips_of(const Problem& problem, const Problem& fresh) {
  std::vector<double> grips(fresh.gripped_dofs().size(), 0.0);
  const auto& pulled = problem.instrument_nodes()[0].nodes;
  for (std::size_t g = 0; g < grips.size(); ++g) {
    const auto at = std::ranges::find(fresh.dofs(), fresh.gripped_dofs()[g]) - fresh.dofs().begin();
    if (std::ranges::binary_search(pulled, static_cast<Index>(at / 3))) {
      grips[g] = kFar[static_cast<int>(at % 3)];
    }
  }
  return grips;
}

TEST_P(SplitLaw, RestsWhereNewtonsMethodRestsOnTheSplitMesh) {
  const LawCase& c = GetParam();
  std::mt19937 random(5);
  const Mesh mesh = shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2);
  const auto problem = std::make_shared<const Problem>(scene_of(c, mesh));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  EdgeSplit crack(*problem);
  const std::vector<double> force =
      c.grip ? std::vector<double>(3 * problem->mesh().nodes.size(), 0.0)
             : shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, kFar);
  const auto expect_as_newton = [&] {
    backend->set_load(load_of(*problem, force, grips_of(*problem, *problem)));
    EXPECT_LE(backend->solve().error, kTolerance);
    static_cast<void>(backend->stress());
    // The grips' boxes hold the fresh mesh's nodes too: those that have parted.
    const Problem fresh(scene_of(c, crack.mesh()));
    std::vector<double> on_fresh = force;
    on_fresh.resize(3 * fresh.mesh().nodes.size(), 0.0);
    const plain::FiniteBody newton(fresh, crack.destroyed);
    const Load load = load_of(fresh, on_fresh, grips_of(*problem, fresh));
    std::vector<Index> nodes(fresh.mesh().nodes.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    std::vector<Vec3> at(nodes.size());
    backend->read_displacement(nodes, at);
    std::vector<double> u;
    for (const Vec3& x : at) u.insert(u.end(), x.begin(), x.end());
    // From nearby: that it is the same rest of several, if there were such.
    const auto expected = newton.solve(load, u);
    EXPECT_LE(displacement_error(fresh.mesh(), crack.destroyed, u, expected.displacement),
              10 * kTolerance);
    std::vector<Voigt> stress(fresh.mesh().tets.size());
    backend->read_stress(stress);
    EXPECT_LE(stress_error(crack.destroyed, stress,
                           newton.stress(expected.displacement, StressMeasure::cauchy)),
              10 * kTolerance);
    if (!c.grip) return;
    // What the grips hold is what the elements at their nodes pull, at parted ones too.
    std::vector<double> reactions(problem->gripped_dofs().size());
    backend->read_reactions(reactions);
    std::vector<double> f(u.size());
    const std::vector<const Law*> laws = fem::laws_of(fresh);
    fem::internal_forces({fresh, laws, crack.destroyed}, expected.displacement, f);
    Vec3 sum = Vec3::Zero(), felt = Vec3::Zero();
    for (std::size_t g = 0; g < reactions.size(); ++g) {
      const auto place =
          std::ranges::find(problem->dofs(), problem->gripped_dofs()[g]) - problem->dofs().begin();
      felt[static_cast<int>(place % 3)] += reactions[g];
    }
    for (Index d : fresh.gripped_dofs()) {
      const auto place = std::ranges::find(fresh.dofs(), d) - fresh.dofs().begin();
      sum[static_cast<int>(place % 3)] += f[static_cast<std::size_t>(place)];
    }
    EXPECT_LE((sum - felt).norm(), 1e-6 * sum.norm());
  };
  const auto first = crack.begin(0.1);
  ASSERT_TRUE(first.moved());
  backend->change(first.change);
  expect_as_newton();
  std::uniform_real_distribution<double> kink(-0.3, 0.3);
  for (int i = 0; i < 5; ++i) {
    const auto step = crack.advance(kink(random));
    ASSERT_TRUE(step.moved() && !step.through) << i;
    backend->change(step.change);
    if (i % 2 == 0) expect_as_newton();
  }
  if (c.grip) {
    EXPECT_GT(Problem(scene_of(c, crack.mesh())).gripped_dofs().size(),
              problem->gripped_dofs().size());
  }
  // Elements of a split body may leave as of any other: here some behind the tip.
  std::vector<Index> gone;
  for (Index e = 0; e < problem->tet_count() && gone.size() < 4; ++e) {
    if ((crack.board.centroid(e) - crack.crack.tips[0].position).norm() < 2) gone.push_back(e);
  }
  for (Index e : gone) crack.destroyed[static_cast<std::size_t>(e)] = 1;
  backend->destroy(gone);
  EXPECT_EQ(backend->node_count(), crack.body.node_count());
  expect_as_newton();
}

/// A board that nothing holds turns and flies: faces that open under way change neither momentum
/// nor energy.
TEST(SplitMotion, AFreeBoardKeepsItsMomentumAndEnergyWhileItParts) {
  std::mt19937 random(3);
  const Mesh mesh = shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2);
  Scene scene = scene_of(LawCase{MaterialLaw::corotated, Route::factor, false}, mesh);
  scene.supports.clear();
  scene.instruments.clear();
  scene.materials["board"].density = 1e-9;
  scene.dynamics = Dynamics{.time_step = 1e-3};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  std::vector<double> v;
  for (const Vec3& x : problem->mesh().nodes) {
    const Vec3 of = Vec3(30, 20, 0) + Vec3(0, 0, 2).cross(x) + Vec3(0, 5 * (x.x() - 5), 0);
    v.insert(v.end(), of.begin(), of.end());
  }
  backend->set_load({});
  backend->set_velocity(v);
  static_cast<void>(backend->advance(1e-3));
  const MotionState begin = backend->motion();
  EdgeSplit crack(*problem);
  for (int i = 0; i < 6; ++i) {
    const auto step = i == 0 ? crack.begin(0) : crack.advance(0.1);
    ASSERT_TRUE(step.moved());
    const MotionState before = backend->motion();
    fem::Change change = step.change;
    change.held = true;  // in motion nothing needs to be
    backend->change(change);
    const MotionState after = backend->motion();
    EXPECT_NEAR(after.kinetic, before.kinetic, 1e-12 * before.kinetic);
    EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(),
              1e-12 * before.angular_momentum.norm());
    EXPECT_NEAR(after.strain_energy, before.strain_energy, 1e-12 * before.strain_energy);
    static_cast<void>(backend->advance(1e-3));
  }
  const MotionState end = backend->motion();
  EXPECT_LE((end.momentum - begin.momentum).norm(), 1e-9 * begin.momentum.norm());
  EXPECT_NEAR(end.kinetic + end.strain_energy + end.dissipated(), end.work,
              1e-9 * std::abs(begin.kinetic));
  EXPECT_EQ(end.broken, 0);  // no element has left
}

}  // namespace
}  // namespace sunder::test
