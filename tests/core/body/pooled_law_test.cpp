// SPDX-License-Identifier: Apache-2.0
// Pooled volume by laws of finite deformation: energy, forces and tangent by their definition, what
// they must agree with, and the pass in lanes.
#include "body/pooled_law.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>

#include "body/assembly.hpp"
#include "body/deformation.hpp"
#include "body/hyperelastic_pass.hpp"
#include "body/law_stress.hpp"
#include "body/tangent_pattern.hpp"
#include "material/finite_stress.hpp"
#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

/// 4 x 3 x 2 mm, "stiff" below of unpooled volume, "soft" above pooled, inner nodes moved, held at
/// x = 0 or nowhere.
Scene pooled_block(double nu, bool held = true, bool both = false,
                   MaterialLaw law = MaterialLaw::neo_hookean) {
  Scene scene;
  scene.mesh = test::shaken_block();
  scene.materials["stiff"] = {50, 0.3, 2.0, law};
  scene.materials["soft"] = {5, nu, 2.0, law};
  scene.materials["soft"].volume = MaterialVolume::pooled;
  if (both) scene.materials["stiff"].volume = MaterialVolume::pooled;
  if (held) {
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
  } else {
    Instrument hand;
    hand.action = Grip{Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Vec3::Zero(), Axes{7}};
    scene.instruments.push_back(hand);
  }
  return scene;
}

constexpr MaterialLaw kLaws[] = {MaterialLaw::linear, MaterialLaw::corotated,
                                 MaterialLaw::neo_hookean, MaterialLaw::saint_venant_kirchhoff};

/// Both materials have fibres along x, which some_shear() stretches.
Scene with_fibres(Scene scene) {
  Fibres f;
  f.direction = Vec3(2, 0, 0);
  f.k1 = 1.5;
  f.k2 = 0.8;
  for (auto& [name, material] : scene.materials) {
    material.fibres = {f};
    if (material.law == MaterialLaw::linear) {
      Fibres& linear = material.fibres[0];
      linear.k1 = linear.k2 = {};
      linear.young_along = 4 * material.young;
      linear.poisson_along = 0.3;
      linear.shear_along = material.young;
    }
  }
  return scene;
}

std::vector<double> moved_by(const Mesh& mesh, const Mat3& f, double size) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> any(-size, size);
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) {
    const Vec3 moved = (f - Mat3::Identity()) * x;
    for (int axis = 0; axis < 3; ++axis) u.push_back(moved[axis] + any(generator));
  }
  return u;
}

Mat3 some_shear() {
  Mat3 f;
  f << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1;
  return f;
}
Mat3 some_turn() { return Eigen::AngleAxisd(1.2, Vec3(1, -2, 3).normalized()).toRotationMatrix(); }

struct SomeBody {
  explicit SomeBody(Scene scene) : problem(std::move(scene)), laws(laws_of(problem)) {}
  [[nodiscard]] HyperelasticBody body() const { return {problem, laws, destroyed}; }
  /// Every seventh element, and all of one patch.
  void destroy_some() {
    destroyed.assign(problem.mesh().tets.size(), 0);
    for (std::size_t e = 0; e < destroyed.size(); e += 7) destroyed[e] = 1;
    for (Index e : problem.pools()->elements(2)) destroyed[static_cast<std::size_t>(e)] = 1;
  }
  Problem problem;
  std::vector<const Law*> laws;
  std::vector<std::uint8_t> destroyed;
};

/// mu |E|^2 by the strain E of a law, and tr E.
struct Strained {
  double squared, trace;
};
Strained strained(MaterialLaw law, const Mat3& f) {
  if (law == MaterialLaw::corotated) {
    Vec3 s = Eigen::JacobiSVD<Mat3>(f).singularValues() - Vec3::Ones();
    return {s.squaredNorm(), s.sum()};
  }
  const Mat3 e = law == MaterialLaw::linear ? Mat3((f + f.transpose()) / 2 - Mat3::Identity())
                                            : Mat3((f.transpose() * f - Mat3::Identity()) / 2);
  return {e.squaredNorm(), e.trace()};
}

/// J as a law measures it.
double ratio_of(MaterialLaw law, const Mat3& f) {
  return law == MaterialLaw::neo_hookean ? f.determinant() : 1 + strained(law, f).trace;
}

/// W of an element whose volume is its own.
double whole_energy(MaterialLaw law, double mu, double lambda, const Mat3& f) {
  if (law == MaterialLaw::neo_hookean) {
    const double log_j = std::log(f.determinant());
    return mu / 2 * (f.squaredNorm() - 3) - mu * log_j + lambda / 2 * log_j * log_j;
  }
  const Strained of = strained(law, f);
  return mu * of.squared + lambda / 2 * of.trace * of.trace;
}

/// Of shape: mu/2 (|F|^2 - 3 J^(2/3)), or mu times the square of the strain's deviator.
double shape_energy(MaterialLaw law, double mu, const Mat3& f) {
  if (law == MaterialLaw::neo_hookean) {
    return mu / 2 * (f.squaredNorm() - 3 * std::pow(f.determinant(), 2.0 / 3));
  }
  const Strained of = strained(law, f);
  return mu * (of.squared - of.trace * of.trace / 3);
}

/// Of volume.
double volume_energy(MaterialLaw law, double mu, double lambda, double j) {
  if (law == MaterialLaw::neo_hookean) {
    return 1.5 * mu * (std::pow(j, 2.0 / 3) - 1) - mu * std::log(j) +
           lambda / 2 * std::log(j) * std::log(j);
  }
  return (lambda + 2 * mu / 3) / 2 * (j - 1) * (j - 1);
}

/// The energy as it is written down: that of shape of each element, U of each patch, and
/// k1/(2 k2) (exp(k2 E^2) - 1) of fibres along x with E = |F x|^2 - 1 > 0.
double by_definition(const SomeBody& of, std::span<const double> u) {
  const Problem& problem = of.problem;
  const auto live = [&](Index e) {
    return of.destroyed.empty() || !of.destroyed[static_cast<std::size_t>(e)];
  };
  const auto gradient = [&](Index e) {
    return Mat3(Mat3::Identity() + displacement_gradient(problem, e, u));
  };
  double sum = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (!live(e)) continue;
    const Mat3 f = gradient(e);
    const MaterialLaw law = problem.material(e).law;
    const double mu = problem.small_strain(e).mu, lambda = problem.small_strain(e).lambda,
                 v = problem.shape(e).volume;
    sum += v * (problem.pools()->of(e) == kNone ? whole_energy(law, mu, lambda, f)
                                                : shape_energy(law, mu, f));
    const double e_of_x = f.col(0).squaredNorm() - 1;
    for (const Fibres& of_x : problem.material(e).fibres) {
      if (e_of_x > 0) sum += v * *of_x.k1 / (2 * *of_x.k2) * std::expm1(*of_x.k2 * e_of_x * e_of_x);
    }
  }
  for (Index p = 0; p < problem.pools()->count(); ++p) {
    const Index first = problem.pools()->elements(p).front();
    const MaterialLaw law = problem.material(first).law;
    double v = 0, now = 0;
    for (Index e : problem.pools()->elements(p)) {
      if (!live(e)) continue;
      v += problem.shape(e).volume;
      now += problem.shape(e).volume * ratio_of(law, gradient(e));
    }
    if (v == 0) continue;
    sum += v * volume_energy(law, problem.small_strain(first).mu,
                             problem.small_strain(first).lambda, now / v);
  }
  return sum;
}

/// df/du by the pattern, dense, per unknown.
Eigen::MatrixXd tangent_of(const SomeBody& of, std::span<const double> u, Tangent kind) {
  const TangentPattern pattern(of.problem);
  const Eigen::MatrixXd ordered(pattern.tangent(of.body(), u, kind));
  const auto& place = pattern.supernodes()->place;
  Eigen::MatrixXd k(ordered.rows(), ordered.cols());
  for (Eigen::Index i = 0; i < k.rows(); ++i) {
    for (Eigen::Index j = 0; j < k.cols(); ++j) {
      const auto [column, row] =
          std::minmax(place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(j)]);
      k(i, j) = ordered(row, column);
    }
  }
  return k;
}

// Fourth-order central differences of 1e-3 mm: error 1e-12 and rounding 1e-13 of the energy.
TEST(PooledLaw, ForcesAreTheGradientOfTheEnergyAndTheTangentIsTheirs) {
  constexpr double kStep = 1e-3;
  struct Case {
    double nu;
    bool fibres;
    MaterialLaw law;
  };
  std::vector<Case> cases{{0.3, false, MaterialLaw::neo_hookean},
                          {0.49, true, MaterialLaw::neo_hookean},
                          {0.49, true, MaterialLaw::corotated}};
  for (MaterialLaw law : kLaws) cases.push_back({0.49, false, law});
  for (const auto& [nu, fibres, law] : cases) {
    const Scene scene = pooled_block(nu, true, false, law);
    SomeBody of(fibres ? with_fibres(scene) : scene);
    of.destroy_some();
    const HyperelasticBody body = of.body();
    std::vector<double> u = moved_by(of.problem.mesh(), some_shear(), 0.05);
    std::vector<double> f(u.size());
    const double w = internal_forces(body, u, f);
    EXPECT_NEAR(w, by_definition(of, u), 1e-13 * w) << nu;
    EXPECT_NEAR(energy(body, u), w, 1e-14 * w);
    const Eigen::MatrixXd k = tangent_of(of, u, Tangent::exact);
    double most = 0;
    for (double x : f) most = std::max(most, std::abs(x));
    for (std::size_t i = 0; i < u.size(); i += 11) {
      const auto at = [&](double by, const auto& what) {
        std::vector<double> there = u;
        there[i] += by;
        return what(there);
      };
      const auto difference = [&](const auto& what) {
        return ((8 * (at(kStep, what) - at(-kStep, what)) -
                 (at(2 * kStep, what) - at(-2 * kStep, what))) /
                (12 * kStep));
      };
      const double slope =
          difference([&](const std::vector<double>& there) { return by_definition(of, there); });
      EXPECT_NEAR(f[i], slope, 1e-8 * most) << nu;
      const Index column = of.problem.dofs()[i];
      if (column == kNone) continue;
      const auto forces = [&](const std::vector<double>& there) {
        std::vector<double> nodal(there.size());
        internal_forces(body, there, nodal);
        Eigen::VectorXd unknowns(of.problem.dof_count());
        gather(of.problem, nodal, {unknowns.data(), static_cast<std::size_t>(unknowns.size())});
        return unknowns;
      };
      const Eigen::VectorXd plus = at(kStep, forces), minus = at(-kStep, forces),
                            plus2 = at(2 * kStep, forces), minus2 = at(-2 * kStep, forces);
      Eigen::VectorXd change = (8 * (plus - minus) - (plus2 - minus2)) / (12 * kStep);
      if (k(column, column) == 1 && change.isZero()) change[column] = 1;  // nothing live there
      EXPECT_LE((k.col(column) - change).cwiseAbs().maxCoeff(), 1e-7 * k.cwiseAbs().maxCoeff())
          << nu;
    }
  }
}

TEST(PooledLaw, ThePassAgreesByAnyNumberOfThreads) {
  struct Case {
    bool both, fibres;
    MaterialLaw law;
  };
  std::vector<Case> cases{{true, false, MaterialLaw::neo_hookean},
                          {false, true, MaterialLaw::neo_hookean},
                          {false, true, MaterialLaw::linear},
                          {false, true, MaterialLaw::saint_venant_kirchhoff}};
  for (MaterialLaw law : kLaws) cases.push_back({false, false, law});
  for (const auto& [both, fibres, law] : cases) {
    const Scene scene = pooled_block(0.4999, true, both, law);
    SomeBody of(fibres ? with_fibres(scene) : scene);
    of.destroy_some();
    const std::vector<double> u = moved_by(of.problem.mesh(), some_turn() * some_shear(), 0.02);
    std::vector<double> f(u.size()), expected(u.size());
    const double w = internal_forces(of.body(), u, expected);
    std::vector<Voigt> stress(of.problem.mesh().tets.size()), right(stress.size());
    element_stresses(of.body(), u, cauchy_stress, right);
    double most = 0, most_stress = 0;
    for (double x : expected) most = std::max(most, std::abs(x));
    for (const Voigt& s : right) most_stress = std::max(most_stress, s.norm());
    std::vector<double> one_thread;
    for (int threads : {1, 2, 3}) {
      HyperelasticPass pass(of.body(), threads);
      const auto found =
          pass.run(u, {.forces = f, .stress = stress, .measure = StressMeasure::cauchy});
      EXPECT_NEAR(found.energy, w, 1e-13 * w);
      for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], expected[i], 1e-12 * most);
      for (std::size_t e = 0; e < stress.size(); ++e) {
        EXPECT_LE((stress[e] - right[e]).norm(), 1e-12 * most_stress);
      }
      if (threads == 1) one_thread = f;
      EXPECT_EQ(f, one_thread) << threads;
    }
  }
}

// The law itself, whatever the patches are: its split is one of the same energy.
TEST(PooledLaw, EvenDeformationIsThatOfTheLaw) {
  for (MaterialLaw named : kLaws) {
    const SomeBody of(pooled_block(0.4999, true, false, named));
    const Law& law = *laws()[static_cast<std::size_t>(named)];
    Mat3 f = some_shear();
    f /= std::cbrt(f.determinant() / 1.001);
    const std::vector<double> u = moved_by(of.problem.mesh(), f, 0);
    std::vector<Voigt> stress(of.problem.mesh().tets.size());
    element_stresses(of.body(), u, cauchy_stress, stress);
    double w = 0;
    for (Index e = 0; e < of.problem.tet_count(); ++e) {
      const SmallStrain& constants = of.problem.small_strain(e);
      const Mat3 by = named == MaterialLaw::linear ? Mat3(Mat3::Identity()) : f;
      const Voigt right = cauchy_stress(law.stress(constants, f), by);
      // ln J = .001 of rounding 1e-16.
      EXPECT_LE((stress[static_cast<std::size_t>(e)] - right).norm(), 1e-11 * right.norm())
          << law.name;
      w += of.problem.shape(e).volume * law.energy(constants, f);
    }
    EXPECT_NEAR(energy(of.body(), u), w, 1e-11 * w) << law.name;
  }
}

TEST(PooledLaw, ATurnedBodyHasTheSameEnergyAndTurnedForces) {
  for (MaterialLaw law :
       {MaterialLaw::corotated, MaterialLaw::neo_hookean, MaterialLaw::saint_venant_kirchhoff}) {
    const SomeBody of(pooled_block(0.4999, false, false, law));
    const Mat3 q = some_turn();
    const std::vector<double> u = moved_by(of.problem.mesh(), some_shear(), 0.02);
    std::vector<double> turned, f(u.size()), g(u.size());
    for (Index n = 0; n < of.problem.node_count(); ++n) {
      const Vec3 x = of.problem.mesh().nodes[static_cast<std::size_t>(n)];
      const Vec3 there = q * (x + Vec3(&u[static_cast<std::size_t>(3 * n)])) + Vec3(1, 2, 3) - x;
      turned.insert(turned.end(), there.data(), there.data() + 3);
    }
    const double w = internal_forces(of.body(), u, f), same = internal_forces(of.body(), turned, g);
    EXPECT_NEAR(w, same, 1e-11 * w);
    double most = 0;
    for (double x : f) most = std::max(most, std::abs(x));
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 0; n < f.size(); n += 3) {
      EXPECT_LE((Vec3(&g[n]) - q * Vec3(&f[n])).norm(), 1e-10 * most);
      sum += Vec3(&g[n]);
    }
    EXPECT_LE(sum.norm(), 1e-10 * most);
  }
}

// At rest: six modes without energy, and the pooled linear law's stiffness.
TEST(PooledLaw, AtRestIsThePooledLinearLaw) {
  for (MaterialLaw law : kLaws) {
    Scene scene = pooled_block(0.4999, false, true, law);
    const SomeBody of(scene);
    for (auto& [name, material] : scene.materials) material.law = MaterialLaw::linear;
    const Problem linear(scene);
    const std::vector<double> none(of.problem.dofs().size(), 0.0);
    std::vector<double> u = none, y = none;
    const auto n = static_cast<Index>(u.size());
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n), right(n, n);
    const HyperelasticBody body = of.body();
    const auto add = [&](Index i, Index j, double value) { k(i, j) += value; };
    for (Index e = 0; e < of.problem.tet_count(); ++e) {
      const ElementMatrix own = element_tangent(body, e, none, Tangent::exact);
      const auto& tet = of.problem.mesh().tets[static_cast<std::size_t>(e)];
      for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 12; ++j) {
          add(3 * tet[static_cast<std::size_t>(i / 3)] + i % 3,
              3 * tet[static_cast<std::size_t>(j / 3)] + j % 3, own(i, j));
        }
      }
    }
    const PatchVolumes volumes(body, none);
    for (Index p = 0; p < of.problem.pools()->count(); ++p) {
      const PatchTangent patch = patch_tangent(
          body, p, none, volumes.stiffness()[static_cast<std::size_t>(p)], Tangent::exact);
      const auto nodes = of.problem.pools()->nodes(of.problem, p);
      for (Eigen::Index i = 0; i < patch.b.size(); ++i) {
        for (Eigen::Index j = 0; j < patch.b.size(); ++j) {
          add(3 * nodes[static_cast<std::size_t>(i / 3)] + static_cast<Index>(i % 3),
              3 * nodes[static_cast<std::size_t>(j / 3)] + static_cast<Index>(j % 3),
              patch.factor * patch.b[i] * patch.b[j]);
        }
      }
    }
    for (Index j = 0; j < n; ++j) {
      u[static_cast<std::size_t>(j)] = 1;
      apply_stiffness(linear, {}, u, y);
      u[static_cast<std::size_t>(j)] = 0;
      right.col(j) = Eigen::Map<const Eigen::VectorXd>(y.data(), n);
    }
    EXPECT_LE((k - right).cwiseAbs().maxCoeff(), 1e-12 * right.cwiseAbs().maxCoeff());
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_LE(values.head(6).cwiseAbs().maxCoeff(), 1e-13 * values[n - 1]);
    EXPECT_GE(values[6], 1e-3);  // mu 1.67, 4 mm long
  }
}

// Stiff fibres by law linear: what patches share is no more than an even stress meets.
TEST(PooledLaw, LinearFibresYieldNoEnergyAtRest) {
  for (const double times : {4.0, 10.0, 50.0}) {
    Scene scene = with_fibres(pooled_block(0.45, false, true, MaterialLaw::linear));
    Scene element = scene;
    for (auto* of : {&scene, &element}) {
      for (auto& [name, material] : of->materials) {
        material.fibres[0].young_along = times * material.young;
        material.fibres[0].poisson_along = 0.45;
        if (of == &element) material.volume = MaterialVolume::element;
      }
    }
    const SomeBody of(scene), alone(element);
    const std::vector<double> none(of.problem.dofs().size(), 0.0);
    const Eigen::MatrixXd k = tangent_of(of, none, Tangent::exact);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GE(values[0], -1e-12 * values[values.size() - 1]) << times;
    // An even strain has the same energy, whoever shares what.
    const std::vector<double> u = moved_by(of.problem.mesh(), some_shear(), 0);
    EXPECT_NEAR(energy(of.body(), u), energy(alone.body(), u), 1e-12 * energy(of.body(), u));
  }
}

TEST(PooledLaw, KnowsNoVolumeBelowNone) {
  const SomeBody of(pooled_block(0.4));
  std::vector<double> u = moved_by(of.problem.mesh(), Mat3(Vec3(1, 1, -0.1).asDiagonal()), 0);
  EXPECT_TRUE(std::isinf(energy(of.body(), u)));
  EXPECT_TRUE(std::isinf(HyperelasticPass(of.body()).energy(u)));
  // One element alone turns inside out; its patch does not.
  const SomeBody both(pooled_block(0.4, true, true));
  u.assign(u.size(), 0.0);
  const auto& tet = both.problem.mesh().tets[20];
  const auto x = [&](int a) { return both.problem.mesh().nodes[static_cast<std::size_t>(tet[a])]; };
  const Vec3 over = 1.2 * ((x(1) + x(2) + x(3)) / 3 - x(0));
  for (int axis = 0; axis < 3; ++axis) {
    u[static_cast<std::size_t>(3 * tet[0] + axis)] = over[axis];
  }
  EXPECT_TRUE(std::isinf(energy(both.body(), u)));
}

}  // namespace
}  // namespace sunder::fem
