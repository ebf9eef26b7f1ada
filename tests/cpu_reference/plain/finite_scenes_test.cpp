// SPDX-License-Identifier: Apache-2.0
// Scenes with laws of finite deformation against the yardstick (Newton with a new factor each
// time) along a tear: the same elements in the same events, and the fields of every frame.
#include <gtest/gtest.h>

#include "cpu_reference/cpu_reference.hpp"
#include "support/whole_run.hpp"

namespace sunder::test {
namespace {

struct FiniteCase {
  const char* name;
  MaterialLaw law;
  StressMeasure stress;
  FractureModel model;
  int families = 0;   // of fibres
  double across = 1;  // their strength, of that along
};

/// As stiff as their matrix, at this slope to the pull.
Fibres slanted(double slope, double young, bool linear) {
  Fibres f;
  f.direction = Vec3(slope, 1, 0.1);
  if (linear) {
    f.young_along = 4 * young;
    f.poisson_along = 0.3;
    f.shear_along = young;
    return f;
  }
  f.k1 = young / 4;
  f.k2 = 0.5;
  f.dispersion = 0.05;
  return f;
}

/// A board that a grip tears from its right edge: 10 x 8 x 1 cells.
Scene finite_board(const FiniteCase& c) {
  Scene scene;
  scene.mesh = structured_board({10, 8, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() < 7 ? "bottom-frame" : x.y() < 25 ? "lower" : x.y() < 43 ? "upper" : "top-frame";
  });
  scene.materials = table1_materials();
  for (auto& [name, material] : scene.materials) {
    material.law = c.law;
    for (int i = 0; i < c.families; ++i) {
      const bool linear = c.law == MaterialLaw::linear;
      material.fibres.push_back(slanted(i == 0 ? 0.8 : -0.5, material.young, linear));
      if (c.across < 1 && material.yield) {
        material.fibres.back().yield_across = c.across * *material.yield;
      }
    }
  }
  scene.supports.push_back({top_edge(), Axes{7}});
  scene.instruments.push_back(tool(Grip{lower_right_corner(), Vec3(0, -30, 0), Axes{2}}));
  scene.fracture.model = c.model;
  scene.fracture.stress = c.stress;
  scene.steps = 20;
  scene.solver.tolerance = 1e-9;
  return scene;
}

class FiniteScene : public ::testing::TestWithParam<FiniteCase> {};

TEST_P(FiniteScene, TearsAsByTheYardstick) {
  const Scene scene = finite_board(GetParam());
  const auto problem = std::make_shared<const Problem>(scene);
  constexpr std::size_t kFractures = 12;
  const WholeRun right = whole_run(problem, plain::create(problem, needs_of(*problem)), kFractures);
  ASSERT_GE(right.elements.size(), kFractures);
  const WholeRun run =
      whole_run(problem, cpu_reference::create(problem, needs_of(*problem)), kFractures);
  ASSERT_NO_FATAL_FAILURE(expect_same_fractures(right, run));
  ASSERT_NO_FATAL_FAILURE(expect_same_frames(*problem, right, run, kCrackTolerance));
  for (std::size_t i = 0; i < right.deformation.size(); ++i) {
    const Deformation &a = run.deformation[i], &b = right.deformation[i];
    EXPECT_NEAR(a.strain, b.strain, 1e-7 * std::abs(b.strain));
    EXPECT_NEAR(a.rotation_deg, b.rotation_deg, 1e-6 * b.rotation_deg);
    EXPECT_EQ(a.inverted, b.inverted);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Laws, FiniteScene,
    ::testing::Values(FiniteCase{"CorotatedCauchy", MaterialLaw::corotated, StressMeasure::cauchy,
                                 FractureModel::a},
                      FiniteCase{"CorotatedBiotModelB", MaterialLaw::corotated, StressMeasure::biot,
                                 FractureModel::b},
                      FiniteCase{"NeoHookean", MaterialLaw::neo_hookean, StressMeasure::cauchy,
                                 FractureModel::a},
                      FiniteCase{"SaintVenantKirchhoff", MaterialLaw::saint_venant_kirchhoff,
                                 StressMeasure::cauchy, FractureModel::a},
                      FiniteCase{"NeoHookeanFibres", MaterialLaw::neo_hookean,
                                 StressMeasure::cauchy, FractureModel::a, 2},
                      FiniteCase{"CorotatedBiotFibres", MaterialLaw::corotated, StressMeasure::biot,
                                 FractureModel::p, 1, 0.4},
                      FiniteCase{"LinearFibresWeakAcross", MaterialLaw::linear,
                                 StressMeasure::cauchy, FractureModel::a, 1, 0.3}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace sunder::test
