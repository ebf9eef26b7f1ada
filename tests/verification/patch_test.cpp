// SPDX-License-Identifier: Apache-2.0
// Patch test: 192 distorted tetrahedra reproduce every state of constant strain.
#include <gtest/gtest.h>

#include <random>

#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/structured_board.hpp"
#include "support/traction.hpp"

namespace sunder::test {
namespace {

constexpr double kYoung = 5, kPoisson = 0.4;
const Vec3 kSize(4, 4, 2);

bool on_surface(const Vec3& x) {
  return (x.array() < 1e-9).any() || (x.array() > kSize.array() - 1e-9).any();
}

/// Inner nodes moved by up to a quarter cell; surface nodes slide in their face or edge.
Mesh distorted_patch() {
  Mesh mesh = structured_board({4, 4, 2, kSize.x(), kSize.y(), kSize.z()});
  std::mt19937 generator(5);
  for (Vec3& x : mesh.nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      const double shift = 0.5 * (static_cast<double>(generator()) / 4294967296.0 - 0.5);
      if (x[axis] > 1e-9 && x[axis] < kSize[axis] - 1e-9) x[axis] += shift;
    }
  }
  return mesh;
}

Scene patch_scene() {
  Scene scene;
  scene.mesh = distorted_patch();
  scene.materials["board"] = {kYoung, kPoisson, 1.0};
  return scene;
}

/// D strain with the Lame constants of E 5, nu 0.4.
Voigt stress_of(const Mat3& gradient) {
  const double mu = kYoung / (2 * (1 + kPoisson));
  const double lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const Mat3 s =
      lambda * gradient.trace() * Mat3::Identity() + mu * (gradient + gradient.transpose());
  Voigt v;
  v << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
  return v;
}

std::vector<double> field(const Mesh& mesh, const Mat3& gradient) {
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) {
    const Vec3 v = gradient * x;
    u.insert(u.end(), {v.x(), v.y(), v.z()});
  }
  return u;
}

// Backward error of the solution, eps, times the condition of the stiffness that is left: under 1e2
// with the whole surface held, some 1e3 held at three nodes.
constexpr double kHeldSurface = 5e-14, kThreeNodes = 2e-13;

void expect_constant(const Body& body, const Mat3& gradient, double residual, double tolerance) {
  const Mesh& mesh = body.problem->mesh();
  const std::vector<std::uint8_t> none(mesh.tets.size(), 0);
  const std::vector<Voigt> expected(mesh.tets.size(), stress_of(gradient));
  const double u_error = displacement_error(mesh, none, body.displacement(), field(mesh, gradient));
  EXPECT_TRUE(u_error <= tolerance) << u_error;
  EXPECT_TRUE(stress_error(none, body.stress(), expected) <= 1e-12);
  EXPECT_TRUE(residual <= 1e-12) << residual;
}

class Patch : public ::testing::TestWithParam<int> {};  // strain component in Voigt order

Mat3 unit_strain(int component) {
  Mat3 h = Mat3::Zero();
  const int row[] = {0, 1, 2, 0, 1, 2}, column[] = {0, 1, 2, 1, 2, 0};
  h(row[component], column[component]) = 0.01;
  return h;
}

TEST_P(Patch, DisplacedSurfaceStrainsTheInsideEvenly) {
  Scene scene = patch_scene();
  std::vector<Index> surface;
  for (Index n = 0; n < scene.mesh.node_count(); ++n) {
    if (on_surface(scene.mesh.nodes[n])) surface.push_back(n);
  }
  Instrument grip;
  grip.action = Grip{surface, Vec3::Zero(), Axes{7}};
  scene.instruments.push_back(grip);
  const Body body(std::move(scene));
  ASSERT_EQ(body.problem->tet_count(), 192);
  const auto u = field(body.problem->mesh(), unit_strain(GetParam()));
  std::vector<double> prescribed;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Index d = body.problem->dofs()[i];
    const auto gripped = body.problem->gripped_dofs();
    if (std::binary_search(gripped.begin(), gripped.end(), d)) prescribed.push_back(u[i]);
  }
  body.load(std::vector<double>(u.size(), 0.0), prescribed);
  const SolveReport report = body.backend->solve();
  expect_constant(body, unit_strain(GetParam()), report.residual, kHeldSurface);
}

TEST_P(Patch, SurfaceTractionStrainsTheInsideEvenly) {
  Scene scene = patch_scene();
  // Three-two-one: the support's forces must come out as zero.
  scene.supports.push_back({std::vector<Index>{0}, Axes{7}});
  scene.supports.push_back({std::vector<Index>{4}, Axes{6}});   // along x: holds y and z
  scene.supports.push_back({std::vector<Index>{20}, Axes{4}});  // along y: holds z
  Mat3 h = unit_strain(GetParam());
  if (GetParam() == 5) h.transposeInPlace();  // u_x = z instead of u_z = x: 0 at the held dofs
  const Body body(std::move(scene));
  const Voigt s = stress_of(h);
  Mat3 stress;
  stress << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  body.load(traction_force(body.problem->mesh(), on_surface,
                           [&](const Vec3& normal) { return Vec3(stress * normal); }));
  const SolveReport report = body.backend->solve();
  expect_constant(body, h, report.residual, kThreeNodes);
}

INSTANTIATE_TEST_SUITE_P(Strains, Patch, ::testing::Range(0, 6));

}  // namespace
}  // namespace sunder::test
