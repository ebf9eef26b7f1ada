// SPDX-License-Identifier: Apache-2.0
// Single kernels against plain double precision on equal inputs, rounded to storage precision
// first; sizes are no multiples of 64. Bounds are derived from the sums' lengths.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "body/deformation.hpp"
#include "body/element.hpp"
#include "gpu/passes/dense_inverse.hpp"
#include "gpu/passes/exact_columns.hpp"
#include "gpu/passes/fields.hpp"
#include "kernels_fixture.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::test {
namespace {

TEST_P(Kernels, PickAndLowRankUpdateInOneAndSeveralPanels) {
  for (const Index n : {1, 43, 300, 597}) {
    for (const std::size_t panel_bytes : {std::size_t{0}, std::size_t{64} * 768 * 8}) {
      const Eigen::MatrixXd x = random_symmetric(n);
      const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
      gpu::DenseInverse inverse(*factory_, n, rows, panel_bytes);
      inverse.upload(
          [&](Index first, Index count) -> Eigen::MatrixXd { return x.middleCols(first, count); });
      std::vector<Index> all(static_cast<std::size_t>(n));
      std::iota(all.begin(), all.end(), 0);
      ASSERT_EQ(inverse.pick(all, all), x);  // storage keeps rounded entries exactly

      // Rank 12 (and 6, a kernel of its own) on every fifth dof, entries of X up to 1: sums of
      // `touched` and of 12 products.
      std::vector<Index> touched;
      for (Index i = 0; i < n; i += 5) touched.push_back(i);
      const auto t = static_cast<Index>(touched.size());
      Eigen::MatrixXd v(t, std::min<Index>(panel_bytes > 0 ? 6 : 12, 2 * t));
      for (double& entry : v.reshaped()) entry = random();
      inverse.update(touched, v);
      const Eigen::MatrixXd z = x(Eigen::all, touched) * v;
      const Eigen::MatrixXd size = x(Eigen::all, touched).cwiseAbs() * v.cwiseAbs();
      const Eigen::MatrixXd error = (inverse.pick(all, all) - (x + z * z.transpose())).cwiseAbs();
      const double units =
          4.0 + static_cast<double>(v.cols()) + (GetParam().fp64 ? static_cast<double>(t) : 1.0);
      const Eigen::MatrixXd allowed =
          units * GetParam().eps() * (x.cwiseAbs() + size * size.transpose());
      EXPECT_TRUE((error.array() <= allowed.array()).all())
          << "n " << n << ", largest " << (error.array() / allowed.array()).maxCoeff();
    }
  }
}

/// X as it is on the device, with an update worked in: its upper triangle is then out of date.
Eigen::MatrixXd updated(gpu::DenseInverse& inverse, Index n) {
  std::vector<Index> touched = {2, 70, n - 1}, all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  inverse.update(touched, Eigen::MatrixXd::Random(3, 3));
  return inverse.pick(all, all);
}

class Products : public Kernels {
 protected:
  void expect_products(std::size_t panel_bytes, bool update);
};

/// Uses the board's fields for positions and residual; any problem of size n does.
void Products::expect_products(std::size_t panel_bytes, bool update) {
  Scene scene;
  scene.mesh = structured_board({6, 5, 2});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  const Index n = problem.dof_count();
  ASSERT_NE(n % 64, 0);
  Eigen::MatrixXd x = random_symmetric(n);
  gpu::DenseInverse inverse(*factory_, n, fields.rows(), panel_bytes);
  inverse.upload(
      [&](Index first, Index count) -> Eigen::MatrixXd { return x.middleCols(first, count); });
  if (update) x = updated(inverse, n);
  gpu::ExactColumns exact(*factory_, fields.rows());
  Eigen::MatrixXd columns(n, 70);
  for (double& entry : columns.reshaped()) entry = uniform_(generator_);
  ASSERT_TRUE(exact.append(columns.leftCols(3)));
  static_cast<void>(exact.append(columns.rightCols(67)));  // what was there stays
  gpu::PartialSums partials(*factory_, fields.rows(),
                            inverse.chunks() + inverse.loaded_chunks({}) + exact.chunks() + 1);
  inverse.bind(partials, fields.residual());
  exact.bind(partials);
  const auto sum = partials.bind_sum(fields.positions(), fields.nodal(gpu::Field::displacement));

  gpu::Loaded load;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(n), c(70);
  for (Index i = 3; i < n; i += 4) {
    load.dofs.push_back(i);
    load.values.push_back(f[i] = uniform_(generator_));
  }
  for (double& entry : c) entry = uniform_(generator_);
  inverse.set_loaded(load);
  exact.set_coefficients(c);
  const auto result = [&](auto&& record) {
    vulkan::Commands commands(*device_);
    commands.begin();
    const std::uint32_t chunks = record(commands);
    partials.record_sum(commands, *sum, chunks, false);
    commands.end();
    commands.submit();
    std::vector<Index> dofs(static_cast<std::size_t>(n));
    std::iota(dofs.begin(), dofs.end(), 0);
    return fields.read_unknowns(gpu::Field::displacement, dofs);
  };
  // Each entry within what the sum of its own products may lose: in fp64 whatever the storage, and
  // the reference loses as much.
  const auto within = [](const Eigen::VectorXd& got, const Eigen::VectorXd& expected,
                         const Eigen::VectorXd& allowed) {
    return ((got - expected).cwiseAbs().array() <= allowed.array()).all();
  };
  const double terms = static_cast<double>(load.dofs.size()) + 70;
  const Eigen::VectorXd few = result([&](vulkan::Commands& commands) {
    const auto chunks = inverse.record_loaded(commands, 0);
    return chunks + exact.record_apply(commands, chunks);
  });
  EXPECT_TRUE(within(
      few, x * f + columns * c,
      2 * terms * kEps64 * (x.cwiseAbs() * f.cwiseAbs() + columns.cwiseAbs() * c.cwiseAbs())));

  std::vector<double> r(fields.rows(), 0.0);
  for (Index i = 0; i < n; ++i) r[static_cast<std::size_t>(i)] = uniform_(generator_);
  fields.write_residual(r);
  const Eigen::Map<const Eigen::VectorXd> rhs(r.data(), n);
  const Eigen::VectorXd dense =
      result([&](vulkan::Commands& commands) { return inverse.record_dense(commands, 0); });
  // Chunks of 64 products, and their inputs, in storage precision.
  EXPECT_TRUE(within(dense, x * rhs,
                     (66 * GetParam().eps() + 2 * static_cast<double>(n) * kEps64) *
                         (x.cwiseAbs() * rhs.cwiseAbs())));
}

TEST_P(Products, DenseAndFewColumnProducts) { expect_products(0, false); }
TEST_P(Products, ProductsOfAnUpdatedMatrix) {
  expect_products(0, true);
  expect_products(64 * 512 * 8, true);
}
TEST_P(Products, ProductsOverSeveralPanels) { expect_products(64 * 512 * 8, false); }

/// f - K u from displacement differences, and what fp64 may lose of each entry: a row sums some 30
/// blocks of three products, each entry of up to 24 elements.
struct Balance {
  std::vector<double> expected, allowed;  // 3 * nodes

  Balance(const Problem& problem, std::span<const double> scale, std::span<const double> force,
          std::span<const double> u)
      : expected(force.begin(), force.end()), allowed(force.size()) {
    constexpr double kUnits = 3 * 30 + 24 + 16;
    std::vector<long double> sum(force.begin(), force.end());
    std::vector<double> size(force.size());
    for (std::size_t i = 0; i < size.size(); ++i) size[i] = std::abs(force[i]);
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const auto& tet = problem.mesh().tets[e];
      const TetShape& shape = problem.shape(e);
      const Material& m = problem.material(e);
      const long double young = m.young, nu = m.poisson, mu = young / (2 * (1 + nu)),
                        lambda = young * nu / ((1 + nu) * (1 - 2 * nu));
      using Vector = Eigen::Matrix<long double, 3, 1>;
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          const Vector ga = shape.gradient.col(a).cast<long double>(),
                       gb = shape.gradient.col(b).cast<long double>(),
                       d = Vec3(&u[3 * tet[b]]).cast<long double>() -
                           Vec3(&u[3 * tet[a]]).cast<long double>();
          const long double weight = scale[e] * shape.volume;
          const Vector force_of =
              weight * (lambda * ga * gb.dot(d) + mu * gb * ga.dot(d) + mu * ga.dot(gb) * d);
          const auto most =
              static_cast<double>(weight * (lambda + 2 * mu) * ga.norm() * gb.norm() * d.norm());
          for (int axis = 0; axis < 3; ++axis) {
            const std::size_t at = 3 * static_cast<std::size_t>(tet[a]) + axis;
            sum[at] -= force_of[axis];
            size[at] += most;
          }
        }
      }
    }
    for (std::size_t i = 0; i < sum.size(); ++i) {
      expected[i] = static_cast<double>(sum[i]);
      allowed[i] = kUnits * kEps64 * size[i];
    }
  }
};

/// Bodies turned by up to 40 deg and strained besides, with destroyed elements and some cut off,
/// against the exact measures of each element.
TEST_P(Kernels, DeformationFromGivenDisplacement) {
  Scene scene;
  scene.mesh = structured_board({5, 4, 3});
  for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  const Index gone = 7, loose = 11;
  std::vector<double> of_body(problem.mesh().tets.size(), 1.0);
  of_body[gone] = problem.scene().fracture.alpha;
  fields.destroy({&gone, 1}, of_body);
  fields.cut_off({&loose, 1});
  int inverted = 0;
  for (const double size : {1e-3, 0.01, 0.03, 0.3}) {  // mm, of edges of some 0.3 to 2.5 mm
    for (const double degrees : {0.0, 8.0, 40.0}) {
      const Mat3 r = Eigen::AngleAxisd(degrees * std::numbers::pi / 180,
                                       Vec3(random(), random(), 1).normalized())
                         .toRotationMatrix();
      std::vector<double> u;
      for (const Vec3& x : problem.mesh().nodes) {
        const Vec3 moved = r * (x + size * Vec3(random(), random(), random())) - x;
        u.insert(u.end(), moved.data(), moved.data() + 3);
      }
      for (Index node : problem.mesh().tets[gone]) u[3 * static_cast<std::size_t>(node)] += size;
      fields.write_displacement(u);
      compute_state(fields);
      Deformation exact;
      double stretch = 0;
      for (Index e = 0; e < problem.tet_count(); ++e) {
        if (e == gone || e == loose) continue;
        const Mat3 h = fem::displacement_gradient(problem, e, u);
        const double strain = fem::principal_strain(h);
        if (std::abs(strain) > std::abs(exact.strain)) exact.strain = strain;
        exact.rotation_deg = std::max(exact.rotation_deg, fem::rotation_deg(h));
        const Mat3 f = Mat3::Identity() + h;
        exact.inverted += f.determinant() <= 0;
        const Vec3 squares = Eigen::SelfAdjointEigenSolver<Mat3>(f.transpose() * f).eigenvalues();
        for (double s : squares)
          stretch = std::max(stretch, std::abs(std::sqrt(std::max(s, 0.0)) - 1));
      }
      const Deformation found = fields.deformation();
      // In fp32 from gradients of more digits; the rotation's axis is right to first order in the
      // stretch (shaders/stress.glsl).
      EXPECT_NEAR(found.strain, exact.strain, 4e-6 * std::abs(exact.strain) + 1e-7) << size;
      EXPECT_NEAR(found.rotation_deg, exact.rotation_deg,
                  (0.7 * stretch * stretch + 1e-5) * exact.rotation_deg + 1e-5)
          << size << " mm, " << degrees << " deg";
      EXPECT_EQ(found.inverted, exact.inverted) << size << " mm, " << degrees << " deg";
      inverted += exact.inverted;
    }
  }
  EXPECT_GT(inverted, 0);
}

/// Random boards, rigid motions far larger than the strain, up to nu 0.499.
TEST_P(Kernels, StressAndResidualFromGivenDisplacement) {
  for (const double nu : {0.0, 0.4, 0.499}) {
    Scene scene;
    scene.mesh = structured_board({5, 4, 3});
    for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
    scene.materials["board"] = {5, nu, 2.0};
    scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{7}});
    Instrument low;
    low.name = "low";
    low.action = Grip{Box{Vec3(-1, -1, -1), Vec3(11, 0.5, 2)}, Vec3(1, -2, 0.5), Axes{5}};
    scene.instruments.push_back(low);
    const Problem problem(scene);
    gpu::Fields fields(*factory_, problem, all_needs());
    std::vector<double> u(3 * problem.mesh().nodes.size());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = 10 + 0.01 * uniform_(generator_);
    fields.write_displacement(u);
    std::vector<double> force(fields.rows(), 0.0), nodal_force(u.size(), 0.0);
    for (std::size_t i = 0; i < u.size(); ++i) {
      const Index dof = problem.dofs()[i];
      if (dof == kNone) continue;
      force[static_cast<std::size_t>(dof)] = nodal_force[i] = uniform_(generator_);
    }
    fields.set_load(force, {});
    // Whose stress would be the largest of all, did it count.
    std::vector<double> of_all;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      of_all.push_back(tensor_norm(fem::stress(problem.shape(e), problem.small_strain(e),
                                               fem::corner_displacement(problem.mesh(), e, u))));
    }
    const double most = *std::ranges::max_element(of_all);
    std::vector<Index> gone;
    std::vector<double> scale(of_all.size(), 1.0);
    for (Index e = 0; e < problem.tet_count(); ++e) {
      if (of_all[e] < 0.98 * most) continue;
      gone.push_back(e);
      scale[e] = problem.scene().fracture.alpha;
    }
    fields.destroy(gone, scale);
    compute_state(fields);

    std::vector<Voigt> stress(scale.size());
    fields.read_stress(stress);
    double largest = 0, worst_ratio = 0;
    Index worst = kNone;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      const auto corners = fem::corner_displacement(problem.mesh(), e, u);
      const Voigt s = scale[e] * fem::stress(problem.shape(e), problem.small_strain(e), corners);
      // Norm product D, B, (u_a - u_0).
      const double norms = elasticity(small_strain({5, nu, std::nullopt})).norm() *
                           problem.shape(e).gradient.rightCols<3>().norm() *
                           (corners.rightCols<3>().colwise() - corners.col(0)).norm();
      EXPECT_LE(tensor_norm(stress[e] - s), 8 * GetParam().eps() / (1 - 2 * nu) * scale[e] * norms)
          << "element " << e << ", nu " << nu;
      if (scale[e] < 1) continue;
      largest = std::max(largest, tensor_norm(s));
      const double ratio = max_shear(s) / 2.0;
      if (ratio > worst_ratio) {
        worst_ratio = ratio;
        worst = e;
      }
    }
    const shaders::Summary summary = fields.state();
    EXPECT_EQ(static_cast<Index>(summary.any_element), worst);
    EXPECT_NEAR(summary.any_ratio, worst_ratio, 32 * GetParam().eps() / (1 - 2 * nu) * worst_ratio);
    EXPECT_NEAR(std::sqrt(summary.stress_squared), largest,
                32 * GetParam().eps() / (1 - 2 * nu) * largest);

    const Balance balance(problem, scale, nodal_force, u);
    std::vector<Index> dofs(static_cast<std::size_t>(problem.dof_count()));
    std::iota(dofs.begin(), dofs.end(), 0);
    std::vector<double> reactions(dofs.size()), residual(dofs.size());
    fields.read_reactions(dofs, reactions);
    fields.residual().read(std::span<double>(residual));
    const auto gripped = problem.gripped_dofs();
    ASSERT_FALSE(gripped.empty());
    // Of free and of gripped unknowns; what each sum may lose by its terms and by their sum.
    std::array<double, 2> squared{}, lost{};
    const double terms = static_cast<double>(dofs.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      if (problem.dofs()[i] == kNone) continue;
      const auto dof = static_cast<std::size_t>(problem.dofs()[i]);
      const bool held = std::binary_search(gripped.begin(), gripped.end(), problem.dofs()[i]);
      const double gap = balance.expected[i], allowed = balance.allowed[i];
      EXPECT_LE(std::abs(-reactions[dof] - gap), allowed) << "unknown " << dof << ", nu " << nu;
      EXPECT_EQ(residual[dof], held ? 0 : -reactions[dof]) << "unknown " << dof;
      squared[held] += gap * gap;
      lost[held] += (2 * std::abs(gap) + allowed) * allowed + terms * kEps64 * gap * gap;
    }
    EXPECT_NEAR(summary.residual_squared, squared[0], lost[0]);
    EXPECT_NEAR(summary.reaction_squared, squared[1], lost[1]);
    EXPECT_EQ(summary.largest_u, *std::ranges::max_element(u));
  }
}

/// A strain of 1e-6 under rotations of one radian (of the linear theory) and an offset: what hangs
/// on by one element moves so. Fp32 rounds the stress of the strain, not that of the rotation.
TEST_P(Kernels, NoRotationCostsStress) {
  constexpr double kNu = 0.4, kStrain = 1e-6;
  Scene scene;
  scene.mesh = structured_board({5, 4, 3});
  for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
  scene.materials["board"] = {5, kNu, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  Mat3 h;  // displacement gradient
  h << 1, -1e6, 2e6, 1e6 + 3, -2, 0.5e6, -2e6, -0.5e6, 4;
  h *= kStrain;
  std::vector<double> u;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 at = Vec3(1, 2, 3) + h * x;
    u.insert(u.end(), at.data(), at.data() + 3);
  }
  fields.write_displacement(u);
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  compute_state(fields);
  std::vector<Voigt> stress(problem.mesh().tets.size());
  fields.read_stress(stress);
  const Mat3 strain = (h + h.transpose()) / 2;
  const double stiffness = elasticity(small_strain({5, kNu, std::nullopt})).norm();
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto corners = fem::corner_displacement(problem.mesh(), e, u);
    const Voigt s = fem::stress(problem.shape(e), problem.small_strain(e), corners);
    const double of_strain = 8 * GetParam().eps() / (1 - 2 * kNu) * stiffness * strain.norm();
    const double of_rotation = 8 * kEps64 * stiffness *
                               problem.shape(e).gradient.rightCols<3>().norm() *
                               (corners.rightCols<3>().colwise() - corners.col(0)).norm();
    EXPECT_LE(tensor_norm(stress[e] - s), of_strain + of_rotation) << "element " << e;
  }
}

/// Principal stresses with every kind of coincidence.
TEST_P(Kernels, YieldRatioOfKnownStates) {
  Scene scene;
  scene.mesh = structured_board({1, 1, 1, 1, 1, 1});
  scene.materials["board"] = {5, 0.25, 2.0};
  scene.supports.push_back({std::vector<Index>{0}, Axes{7}});
  scene.supports.push_back({std::vector<Index>{1, 2}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const Vec3& strain : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(0, 0, 0),
                             Vec3(1, -1, 0), Vec3(1, 1 + 1e-6, -2), Vec3(-3, 1e-3, 2)}) {
    for (const bool rotated : {false, true}) {
      Mat3 h = 0.01 * strain.asDiagonal();
      if (rotated) h = rotation * h * rotation.transpose();
      std::vector<double> u;
      for (const Vec3& x : problem.mesh().nodes) {
        const Vec3 at = h * x;
        u.insert(u.end(), at.data(), at.data() + 3);
      }
      fields.write_displacement(u);
      compute_state(fields);
      // tau = mu (largest - smallest principal strain), mu = 2 MPa; yield 2 MPa.
      const double ratio = 0.01 * (strain.maxCoeff() - strain.minCoeff());
      EXPECT_NEAR(fields.state().any_ratio, ratio, 16 * GetParam().eps() * 0.01 * 4)
          << strain.transpose() << (rotated ? " rotated" : "");
    }
  }
}

/// The same for the largest principal stress; compression in all directions has no ratio.
TEST_P(Kernels, PrincipalRatioOfKnownStates) {
  Scene scene;
  scene.mesh = structured_board({1, 1, 1, 1, 1, 1});
  scene.materials["board"] = {5, 0.25, 2.0};
  scene.supports.push_back({std::vector<Index>{0}, Axes{7}});
  scene.supports.push_back({std::vector<Index>{1, 2}, Axes{7}});
  scene.fracture.model = FractureModel::p;
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  fields.set_load(std::vector<double>(fields.rows(), 0.0), {});
  const Mat3 rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const Vec3& strain :
       {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(0, 0, 0), Vec3(1, -1, 0),
        Vec3(1, 1 + 1e-6, -2), Vec3(-3, 1e-3, 2), Vec3(2, -1, -1), Vec3(1, 1, -2), Vec3(4, 2, 1),
        Vec3(-1, 0, 0), Vec3(-1, -1, -2)}) {
    for (const bool rotated : {false, true}) {
      Mat3 h = 0.01 * strain.asDiagonal();
      if (rotated) h = rotation * h * rotation.transpose();
      std::vector<double> u;
      for (const Vec3& x : problem.mesh().nodes) {
        const Vec3 at = h * x;
        u.insert(u.end(), at.data(), at.data() + 3);
      }
      fields.write_displacement(u);
      compute_state(fields);
      // s1 = lambda tr + 2 mu (largest principal strain), lambda = mu = 2 MPa; yield 2 MPa.
      const double ratio = std::max(0.0, 0.01 * (strain.sum() + 2 * strain.maxCoeff()));
      EXPECT_NEAR(fields.state().any_ratio, ratio, 16 * GetParam().eps() * 0.01 * 12)
          << strain.transpose() << (rotated ? " rotated" : "");
    }
  }
}

const auto kAllNumbers =
    testing::Values(Numbers{gpu::Variant::gpu, false}, Numbers{gpu::Variant::gpu, true},
                    Numbers{gpu::Variant::lvp, false}, Numbers{gpu::Variant::lvp, true});

INSTANTIATE_TEST_SUITE_P(All, Kernels, kAllNumbers,
                         [](const auto& tested) { return name_of(tested.param); });
INSTANTIATE_TEST_SUITE_P(All, Products, kAllNumbers,
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
