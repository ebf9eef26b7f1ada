// SPDX-License-Identifier: Apache-2.0
// The yardstick's bodies by hand values, without anything that it is to judge.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cpu_reference/plain/plain.hpp"
#include "plane.hpp"
#include "sunder/error.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"
#include "support/traction.hpp"

namespace sunder::test {
namespace {

/// A bar of 4 x 2 x 1 mm whose inner nodes are moved at random; E = 5 MPa, nu = 1/4.
Scene bar() {
  Scene scene;
  scene.mesh = structured_board({4, 2, 2, 4, 2, 1});
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  for (Vec3& x : scene.mesh.nodes) {
    const bool inside = x.x() > 0 && x.x() < 4 && x.y() > 0 && x.y() < 2 && x.z() > 0 && x.z() < 1;
    if (inside) x += Vec3(any(generator), any(generator), any(generator));
  }
  scene.materials["board"] = {5, 0.25, 2.0};
  return scene;
}

/// Slides on the planes x = 0, y = 0 and z = 0.
void hold(Scene& scene) {
  for (int axis = 0; axis < 3; ++axis) {
    scene.supports.push_back({plane(axis, 0), Axes{static_cast<std::uint8_t>(1 << axis)}});
  }
}

/// u = e (x, -nu y, -nu z) for a strain e along x, stress E e.
void expect_stretched(const Problem& problem, const plain::Solution& s, double strain) {
  for (Index n = 0; n < problem.node_count(); ++n) {
    const Vec3& x = problem.mesh().nodes[n];
    const Vec3 expected = strain * Vec3(x.x(), -0.25 * x.y(), -0.25 * x.z());
    EXPECT_LE((Vec3(&s.displacement[3 * n]) - expected).norm(), 1e-15);
  }
  for (const Voigt& stress : s.stress) {
    EXPECT_LE((stress - 5 * strain * Voigt::Unit(0)).norm(), 1e-14);
  }
  EXPECT_LE(s.error, 1e-15);
  EXPECT_LE(s.residual, 1e-15);
}

TEST(PlainBody, StretchesEvenlyUnderATraction) {
  Scene scene = bar();
  hold(scene);
  const Problem problem(std::move(scene));
  const auto force = traction_force(
      problem.mesh(), [](const Vec3& x) { return x.x() > 3.999; },
      [](const Vec3&) { return Vec3(0.05, 0, 0); });
  plain::Body body(problem);
  expect_stretched(problem, body.solve(load_of(problem, force, {})), 0.01);
}

// 2 mm^2 at 0.05 MPa take 0.1 N.
TEST(PlainBody, StretchesEvenlyByAGripThatFeelsTheForce) {
  Scene scene = bar();
  hold(scene);
  Instrument grip;
  grip.action = Grip{plane(0, 4), Vec3(0.04, 0, 0), Axes{1}};
  scene.instruments.push_back(grip);
  const Problem problem(std::move(scene));
  const std::vector<double> moved(problem.gripped_dofs().size(), 0.04);
  plain::Body body(problem);
  const plain::Solution s = body.solve({{}, {}, moved});
  expect_stretched(problem, s, 0.01);
  ASSERT_EQ(s.reactions.size(), moved.size());
  double sum = 0;
  for (double r : s.reactions) sum += r;
  EXPECT_NEAR(sum, 0.1, 1e-14);
}

// A chain of two bars, the second destroyed: it has alpha of its stiffness, 1/alpha of its strain.
TEST(PlainBody, DestroyedElementsKeepAlphaOfTheirStiffness) {
  for (const double alpha : {1e-6, 1e-3, 0.5}) {
    Scene scene = bar();
    hold(scene);
    scene.fracture.alpha = alpha;
    const Problem problem(std::move(scene));
    const auto force = traction_force(
        problem.mesh(), [](const Vec3& x) { return x.x() > 3.999; },
        [](const Vec3&) { return Vec3(0.05, 0, 0); });
    const Load load = load_of(problem, force, {});
    // Everything destroyed: stress stays, displacement grows by 1/alpha.
    std::vector<Index> all(problem.mesh().tets.size());
    for (std::size_t e = 0; e < all.size(); ++e) all[e] = static_cast<Index>(e);
    plain::Body body(problem);
    const plain::Solution whole = body.solve(load);
    body.destroy(all);
    const plain::Solution torn = body.solve(load);
    const plain::Solution anew =
        plain::Body(problem, std::vector<std::uint8_t>(all.size(), 1)).solve(load);
    EXPECT_EQ(torn.displacement, anew.displacement);
    for (std::size_t i = 0; i < torn.displacement.size(); ++i) {
      EXPECT_NEAR(torn.displacement[i] * alpha, whole.displacement[i], 1e-15);
    }
    for (const Voigt& s : torn.stress) EXPECT_LE((s - 0.05 * Voigt::Unit(0)).norm(), 1e-14);
  }
}

TEST(PlainBody, MeasuresTheLargestDeformationOfWhatCounts) {
  const Problem problem([] {
    Scene scene = bar();
    hold(scene);
    return scene;
  }());
  plain::Body body(problem);
  // Two elements bear it, each in turn left out: the whole is turned by 10 degrees about z.
  const double c = std::cos(0.17453292519943295), s = std::sin(0.17453292519943295);
  std::vector<double> u;
  for (const Vec3& x : problem.mesh().nodes) {
    for (double v : {(c - 1) * x.x() - s * x.y(), s * x.x() + (c - 1) * x.y(), -0.3 * x.z()}) {
      u.push_back(v);
    }
  }
  std::vector<std::uint8_t> none(problem.mesh().tets.size(), 0), all(none.size(), 1);
  const Deformation most = body.deformation(u, none);
  EXPECT_NEAR(most.strain, -0.3, 1e-14);
  EXPECT_NEAR(most.rotation_deg, 10, 1e-12);
  EXPECT_EQ(most.inverted, 0);
  EXPECT_EQ(body.deformation(u, all).rotation_deg, 0);
  for (std::size_t i = 2; i < u.size(); i += 3) u[i] *= 5;  // by one and a half heights
  EXPECT_EQ(body.deformation(u, none).inverted, problem.tet_count());
  body.destroy(std::vector<Index>{0, 1, 2});
  EXPECT_EQ(body.deformation(u, none).inverted, problem.tet_count() - 3);
}

TEST(PlainBackend, SummarisesByTheScenesMeasure) {
  struct Row {
    FractureModel model;
    YieldMeasure measure;
    double ratio;  // of 0.05 MPa along x against 2 MPa
  };
  for (const Row& row : {Row{FractureModel::a, YieldMeasure::max_shear, 0.0125},
                         Row{FractureModel::a, YieldMeasure::tresca, 0.025},
                         Row{FractureModel::p, YieldMeasure::max_shear, 0.025}}) {
    Scene scene = bar();
    hold(scene);
    scene.fracture.model = row.model;
    scene.fracture.yield_measure = row.measure;
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    const auto backend = plain::create(problem, all_needs());
    const auto force = traction_force(
        problem->mesh(), [](const Vec3& x) { return x.x() > 3.999; },
        [](const Vec3&) { return Vec3(0.05, 0, 0); });
    backend->set_load(load_of(*problem, force, {}));
    EXPECT_LE(backend->solve().error, 1e-15);
    const StressSummary summary = backend->stress();
    EXPECT_NEAR(summary.any.ratio, row.ratio, 1e-14);
    backend->exclude_candidates({&summary.any.element, 1});
    EXPECT_NE(backend->stress().candidate.element, summary.any.element);
    EXPECT_EQ(backend->stress().any.element, summary.any.element);
    EXPECT_EQ(summary.over, 0);
    std::vector<double> intact(force.size()), torn(force.size());
    backend->destroy({&summary.any.element, 1});
    backend->solve();
    EXPECT_NE(backend->stress().any.element, summary.any.element);
    backend->read_displacement(torn);
    backend->solve_pristine(load_of(*problem, force, {}), intact);
    EXPECT_NE(intact, torn);
    EXPECT_NEAR(intact[3 * 4], 0.04, 1e-14);  // of the node at (4, 0, 0)
  }
}

}  // namespace
}  // namespace sunder::test
