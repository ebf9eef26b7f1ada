// SPDX-License-Identifier: Apache-2.0
// The pass in lanes against the scalar laws and sums that it must agree with.
#include "body/hyperelastic_pass.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "body/deformation.hpp"
#include "core/material/random_gradients.hpp"
#include "material/corotated.hpp"
#include "material/finite_stress.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"
#include "support/structured_board.hpp"

namespace sunder::fem {
namespace {

using test::RandomGradients;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// Tetrahedra that share no node, each held at three corners: every one can have a gradient of its
/// own. Two materials in turns.
Scene apart(Index count) {
  Scene scene;
  scene.mesh.volumes = {{"soft", 1}, {"hard", 2}};
  for (Index e = 0; e < count; ++e) {
    const Vec3 at(3 * (e % 50), 3 * (e / 50), 0);
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.1, 0.8, 0), Vec3(0.3, 0.4, 0.9)}) {
      scene.mesh.nodes.push_back(at + x);
    }
    scene.mesh.tets.push_back({4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3});
    scene.mesh.volume_of.push_back(e % 2);
  }
  scene.materials["soft"] = {5, 0.4, 2.0};
  scene.materials["hard"] = {50, 0.49, 2.0};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e4, 1e4, 0.1)}, Axes{7}});
  return scene;
}

std::vector<double> displaced(const Problem& problem, std::span<const Mat3> gradients) {
  std::vector<double> u(problem.dofs().size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto& tet = problem.mesh().tets[e];
    for (Index n : tet) {
      const Vec3 moved = (gradients[e] - Mat3::Identity()) *
                         (problem.mesh().nodes[n] - problem.mesh().nodes[tet[0]]);
      for (int axis = 0; axis < 3; ++axis) u[3 * n + axis] = moved[axis];
    }
  }
  return u;
}

Mat3 gradient(const Problem& problem, Index e, std::span<const double> u) {
  return Mat3::Identity() + displacement_gradient(problem, e, u);
}

/// Gradients of all kinds; of the last ones the rotation is all but undetermined.
enum class Kind { small, strained, stretched, inverted, any, flat, doubtful };
constexpr Kind kKinds[] = {Kind::small, Kind::strained, Kind::stretched, Kind::inverted,
                           Kind::any,   Kind::flat,     Kind::doubtful};
Mat3 gradient_of(Kind kind, RandomGradients& any) {
  const auto turned = [&](double least, double most) {
    return any.turned({any.number(least, most), any.number(least, most), any.number(least, most)});
  };
  switch (kind) {
    case Kind::small:
      return any.rotation() * (Mat3::Identity() + 1e-6 * any.matrix());
    case Kind::strained:
      return turned(0.6, 1.4);
    case Kind::stretched:
      return turned(0.05, 2);
    case Kind::inverted:
      return any.turned({any.number(0.8, 2), any.number(0.8, 2), any.number(-0.7, 0)});
    case Kind::any:
      return Mat3::Identity() + any.matrix();
    case Kind::flat:
      return any.turned({1, any.number(0, 0.2), any.number(-1e-3, 1e-3)});
    case Kind::doubtful:
      break;
  }
  const double s = any.number(0.3, 1);
  return any.turned({1, s, -s * (1 - 1e-4 * any.number(0, 1))});
}

class HyperelasticPassOf : public testing::Test {
 protected:
  static constexpr Index kCount = 1003;  // fillers in the last block
  Problem problem{apart(kCount)};
  RandomGradients any{21};
  std::vector<Mat3> gradients(Kind kind) {
    std::vector<Mat3> all;
    for (Index e = 0; e < kCount; ++e) all.push_back(gradient_of(kind, any));
    return all;
  }
};

/// Bounds of rounding: how far a law's stress and the rotation may be off, by their conditions.
struct Rounding {
  double p, r;
};
Rounding rounding_of(const Law& law, const SmallStrain& constants, const Mat3& f, const Mat3& p) {
  constexpr double kUnit = 2e-14;  // some hundred roundings
  const Vec3 s = singular_values(f).s;
  const double r = kUnit * std::max(1.0, s[0] / (s[1] + s[2]));
  const double stiff = constants.stiffest();
  if (&law == &kCorotated) return {r * (p.norm() + stiff), r};
  if (&law != &kNeoHookean) return {kUnit * (p.norm() + stiff * f.norm()), r};
  // F^-T and ln J have the condition of F.
  const double inverse = f.inverse().norm();
  return {kUnit * (p.norm() + stiff * inverse) * std::max(1.0, f.norm() * inverse), r};
}

TEST_F(HyperelasticPassOf, EachElementAgreesWithTheScalarLaws) {
  for (const Law* law : laws()) {
    const auto of = one_law(problem, *law);
    HyperelasticPass pass({problem, of}, 1);
    for (Kind kind : kKinds) {
      const auto u = displaced(problem, gradients(kind));
      std::vector<double> expected(u.size()), f(u.size());
      std::vector<Voigt> cauchy(kCount), biot(kCount);
      const double energy_expected = internal_forces({problem, of}, u, expected);
      const auto found =
          pass.run(u, {.forces = f, .stress = cauchy, .measure = StressMeasure::cauchy});
      pass.run(u, {.stress = biot, .measure = StressMeasure::biot});
      if (std::isfinite(energy_expected)) {
        EXPECT_NEAR(found.energy, energy_expected, 1e-13 * (energy_expected + 1)) << law->name;
      } else {
        EXPECT_EQ(found.energy, kInfinite);
      }
      for (Index e = 0; e < kCount; ++e) {
        const Mat3 at = gradient(problem, e, u);
        const auto where = [&] {
          return std::string(law->name) + " " + std::to_string(static_cast<int>(kind)) + " " +
                 std::to_string(e);
        };
        if (!std::isfinite(law->energy(problem.small_strain(e), at))) {
          EXPECT_FALSE(cauchy[e].allFinite()) << where();
          for (int i = 0; i < 12; ++i) EXPECT_EQ(f[12 * e + i], 0) << where();
          continue;
        }
        const Mat3 p = law->stress(problem.small_strain(e), at);
        const Rounding rounding = rounding_of(*law, problem.small_strain(e), at, p);
        for (int i = 0; i < 12; ++i) {  // areas of a mm^2
          EXPECT_NEAR(f[12 * e + i], expected[12 * e + i], rounding.p) << where();
        }
        // The linear law knows one measure alone.
        const Mat3 by = law == &kLinear ? Mat3(Mat3::Identity()) : at;
        EXPECT_LE((biot[e] - biot_stress(p, by)).norm(), rounding.p + rounding.r * p.norm())
            << where();
        const double j = std::abs(at.determinant()), condition = at.norm() * at.inverse().norm();
        EXPECT_LE((cauchy[e] - cauchy_stress(p, by)).norm(),
                  (rounding.p + 1e-14 * condition * p.norm()) * at.norm() / j)
            << where();
      }
    }
  }
}

// Every second element has fibres, so that blocks of both kinds are there.
TEST(HyperelasticPassWithFibres, AgreesWithTheScalarLaws) {
  for (const MaterialLaw law : {MaterialLaw::linear, MaterialLaw::corotated,
                                MaterialLaw::neo_hookean, MaterialLaw::saint_venant_kirchhoff}) {
    Scene scene = apart(203);
    for (auto& [name, material] : scene.materials) material.law = law;
    Fibres of;
    of.direction = Vec3(1, -2, 0.5);
    if (law == MaterialLaw::linear) {
      of.young_along = 20;
      of.poisson_along = 0.3;
      of.shear_along = 6;
    } else {
      of.k1 = 3;
      of.k2 = 0.4;
      of.dispersion = 0.1;
    }
    scene.materials["soft"].fibres = {of};
    const Problem problem(scene);
    RandomGradients any(5);
    std::vector<Mat3> all;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      all.push_back(gradient_of(Kind::strained, any));
    }
    const auto u = displaced(problem, all);
    const auto by = laws_of(problem);
    const HyperelasticBody body{problem, by};
    std::vector<double> expected(u.size()), f(u.size());
    std::vector<Voigt> stress(all.size()), right(all.size());
    const double w = internal_forces(body, u, expected);
    const auto largest = [](const auto& values) {
      double most = 0;
      for (const double x : values) most = std::max(most, std::abs(x));
      return most;
    };
    for (const auto& [measure, function] :
         {std::pair(StressMeasure::cauchy, &cauchy_stress), {StressMeasure::biot, &biot_stress}}) {
      element_stresses(body, u, function, right);
      double most = 0;
      for (const Voigt& s : right) most = std::max(most, s.norm());
      const auto found =
          HyperelasticPass(body, 2).run(u, {.forces = f, .stress = stress, .measure = measure});
      EXPECT_NEAR(found.energy, w, 1e-13 * w);
      for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_NEAR(f[i], expected[i], 1e-12 * largest(expected));
      }
      for (std::size_t e = 0; e < stress.size(); ++e) {
        EXPECT_LE((stress[e] - right[e]).norm(), 1e-12 * most) << e;
      }
    }
  }
}

// What takes the scalar way: rotations that are all but undetermined, and little else.
TEST_F(HyperelasticPassOf, FewElementsTakeTheScalarWay) {
  const auto of = one_law(problem, kCorotated);
  HyperelasticPass pass({problem, of}, 1);
  const auto repaired = [&](Kind kind) {
    (void)pass.energy(displaced(problem, gradients(kind)));
    return static_cast<double>(pass.repaired()) / kCount;
  };
  EXPECT_EQ(repaired(Kind::small), 0);
  EXPECT_EQ(repaired(Kind::strained), 0);
  EXPECT_EQ(repaired(Kind::stretched), 0);
  EXPECT_LE(repaired(Kind::inverted), 0.1);
  EXPECT_LE(repaired(Kind::any), 0.05);
  EXPECT_EQ(repaired(Kind::doubtful), 1);
}

TEST_F(HyperelasticPassOf, DeformationIsThatOfTheLargestElement) {
  const auto of = one_law(problem, kCorotated);
  for (Kind kind : kKinds) {
    const auto u = displaced(problem, gradients(kind));
    HyperelasticPass pass({problem, of}, 1);
    std::vector<Index> gone, loose;
    for (Index e = 0; e < kCount; e += 5) gone.push_back(e);
    for (Index e = 2; e < kCount; e += 7) loose.push_back(e);
    pass.destroy(gone);
    pass.cut_off(loose);
    const Deformation found = pass.run(u, {.deformation = true}).deformation;
    Deformation expected;
    for (Index e = 0; e < kCount; ++e) {
      if (e % 5 == 0 || e % 7 == 2) continue;
      const Mat3 at = gradient(problem, e, u);
      for (double s : singular_values(at).s) {
        if (std::abs(s - 1) > std::abs(expected.strain)) expected.strain = s - 1;
      }
      const double cosine = (polar(at).rotation.trace() - 1) / 2;
      expected.rotation_deg = std::max(
          expected.rotation_deg, std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi);
      expected.inverted += at.determinant() <= 0;
    }
    EXPECT_NEAR(found.strain, expected.strain, 1e-6 * std::abs(expected.strain));
    EXPECT_NEAR(found.rotation_deg, expected.rotation_deg, 1e-5);
    EXPECT_EQ(found.inverted, expected.inverted) << static_cast<int>(kind);
  }
}

// Shear by .6 with a stretch by .2: sym grad u is [[0, .3], [.3, .2]], C [[1, .6], [.6, 1.8]].
TEST_F(HyperelasticPassOf, TheLinearLawsStrainIsOfSmallDisplacements) {
  Mat3 f = Mat3::Identity();
  f(0, 1) = 0.6;
  f(1, 1) = 1.2;
  const auto u = displaced(problem, std::vector<Mat3>(kCount, f));
  const auto linear = one_law(problem, kLinear), corotated = one_law(problem, kCorotated);
  HyperelasticPass by_linear({problem, linear}, 1), by_corotated({problem, corotated}, 1);
  EXPECT_NEAR(by_linear.run(u, {.deformation = true}).deformation.strain, 0.1 + std::sqrt(0.1),
              1e-12);
  EXPECT_NEAR(by_corotated.run(u, {.deformation = true}).deformation.strain,
              std::sqrt(1.4 + std::sqrt(0.52)) - 1, 1e-12);
}

// Uniaxial, shear, a ball, a rotation by the half turn: every element is as good as the largest.
TEST_F(HyperelasticPassOf, DeformationOfUniformFieldsByHand) {
  const auto of = one_law(problem, kNeoHookean);
  HyperelasticPass pass({problem, of}, 1);
  struct Row {
    Mat3 f;
    double strain, rotation;
  };
  const auto about_z = [](double degrees) {
    return Mat3(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitZ()));
  };
  const Mat3 turned = any.rotation();
  for (const Row& row :
       {Row{Mat3::Identity(), 0, 0}, Row{Vec3(1.5, 1, 1).asDiagonal(), 0.5, 0},
        Row{Vec3(1, 0.3, 1).asDiagonal(), -0.7, 0}, Row{Vec3(1.2, 1.2, 0.8).asDiagonal(), 0.2, 0},
        Row{Vec3(1.1, 0.8, 0.8).asDiagonal(), -0.2, 0},
        Row{turned * Vec3(2, 2, 2).asDiagonal() * turned.transpose(), 1, 0},
        Row{about_z(180), 0, 180}, Row{about_z(90) * 1.25, 0.25, 90}, Row{about_z(1e-4), 0, 1e-4},
        Row{Vec3(1.5, 1.2, -0.4).asDiagonal(), -1.4, 0}}) {
    const std::vector<Mat3> all(kCount, row.f);
    const auto found = pass.run(displaced(problem, all), {.deformation = true}).deformation;
    EXPECT_NEAR(found.strain, row.strain, 1e-12) << row.f;
    EXPECT_NEAR(found.rotation_deg, row.rotation, 1e-9 + 1e-6 * row.rotation) << row.f;
    EXPECT_EQ(found.inverted, row.f.determinant() > 0 ? 0 : kCount);
  }
}

TEST_F(HyperelasticPassOf, LargestStressIsThatOfWhatCounts) {
  const auto of = one_law(problem, kCorotated);
  const auto u = displaced(problem, gradients(Kind::strained));
  HyperelasticPass pass({problem, of}, 1);
  std::vector<Voigt> stress(kCount);
  std::vector<std::uint8_t> left(kCount, 1);
  for (int round = 0; round < 20; ++round) {
    const double largest =
        pass.run(u, {.stress = stress, .measure = StressMeasure::cauchy}).largest;
    Index most = kNone;
    double expected = 0;
    for (Index e = 0; e < kCount; ++e) {
      const Voigt& s = stress[e];
      const double norm = std::sqrt(s.squaredNorm() + s.tail<3>().squaredNorm());
      if (!left[e] || norm <= expected) continue;
      expected = norm;
      most = e;
    }
    EXPECT_NEAR(largest, expected, 4e-16 * expected);
    EXPECT_EQ(pass.run(u, {.measure = StressMeasure::cauchy}).largest, largest);
    left[most] = 0;
    if (round % 2 == 0) {
      pass.destroy({&most, 1});
    } else {
      pass.cut_off({&most, 1});
    }
  }
}

// No hang, no finite energy, nothing of it beside the element.
TEST_F(HyperelasticPassOf, SaysWhatIsNotFinite) {
  for (const Law* law : laws()) {
    const auto of = one_law(problem, *law);
    HyperelasticPass pass({problem, of}, 1);
    auto u = displaced(problem, gradients(Kind::strained));
    std::vector<double> before(u.size()), f(u.size());
    pass.internal_forces(u, before);
    for (double bad : {kNoNumber, kInfinite, 1e200}) {
      u[12 * 500 + 11] = bad;
      const auto found = pass.run(u, {.forces = f, .measure = StressMeasure::biot});
      EXPECT_FALSE(std::isfinite(found.energy)) << law->name << " " << bad;
      EXPECT_FALSE(std::isfinite(found.largest)) << law->name << " " << bad;
      for (std::size_t i = 0; i < f.size(); ++i) {
        EXPECT_EQ(f[i], i / 12 == 500 ? 0 : before[i]) << law->name << " " << bad;
      }
    }
    // What is gone does not matter.
    const Index gone = 500;
    pass.destroy({&gone, 1});
    const auto found =
        pass.run(u, {.forces = f, .measure = StressMeasure::cauchy, .deformation = true});
    EXPECT_TRUE(std::isfinite(found.energy)) << law->name;
    EXPECT_TRUE(std::isfinite(found.largest)) << law->name;
    EXPECT_TRUE(std::isfinite(found.deformation.strain)) << law->name;
  }
}

TEST_F(HyperelasticPassOf, ALawThatIsNotMadeForLanesTakesItsOwnWay) {
  const Law own{"own", kNeoHookean.energy, kNeoHookean.stress, kNeoHookean.tangent};
  const auto of = one_law(problem, own), made = one_law(problem, kNeoHookean);
  const auto u = displaced(problem, gradients(Kind::any));
  std::vector<double> f(u.size()), expected(u.size());
  HyperelasticPass pass({problem, of}, 1);
  EXPECT_EQ(pass.internal_forces(u, f), internal_forces({problem, made}, u, expected));
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(f[i], expected[i], 1e-13 * (1 + std::abs(expected[i])));
  }
}

// A connected body that mixes laws.
class HyperelasticPassOfABody : public testing::Test {
 protected:
  static Scene block() {
    Scene scene;
    scene.mesh = test::structured_board({7, 6, 5, 7, 6, 5}, [](const Vec3& x) {
      return x.y() < 1 ? "a" : x.y() < 3 ? "b" : x.y() < 4 ? "c" : "d";
    });
    for (const char* name : {"a", "b", "c", "d"}) scene.materials[name] = {5, 0.4, 2.0};
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 9, 9)}, Axes{7}});
    return scene;
  }
  static std::vector<double> moved(const Problem& problem) {
    RandomGradients any(3);
    Mat3 f;
    f << 1.2, 0.3, 0, -0.1, 0.9, 0.2, 0.05, 0, 1.1;
    const Mat3 h = any.rotation() * f - Mat3::Identity();
    std::vector<double> u;
    for (const Vec3& x : problem.mesh().nodes) {
      const Vec3 at = h * x + 0.05 * any.vector();
      u.insert(u.end(), at.begin(), at.end());
    }
    return u;
  }
  Problem problem{block()};
  std::vector<double> u = moved(problem);
  std::vector<const Law*> of{&kCorotated, &kNeoHookean, &kCorotated, &kSaintVenantKirchhoff};
  std::vector<std::uint8_t> destroyed = std::vector<std::uint8_t>(problem.mesh().tets.size(), 0);
};

void expect_same_sums(HyperelasticPass& pass, const HyperelasticBody& body,
                      std::span<const double> u) {
  std::vector<double> f(u.size()), expected(u.size());
  const double w = internal_forces(body, u, expected);
  EXPECT_NEAR(pass.internal_forces(u, f), w, 1e-13 * w);
  EXPECT_NEAR(pass.energy(u), w, 1e-13 * w);
  double largest = 0;
  for (double x : expected) largest = std::max(largest, std::abs(x));
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], expected[i], 1e-13 * largest);
}

TEST_F(HyperelasticPassOfABody, FollowsEventsAndChangesOfLaws) {
  const HyperelasticBody body{problem, of, destroyed};
  HyperelasticPass pass(body, 1);
  expect_same_sums(pass, body, u);
  std::vector<Index> gone;
  for (Index e = 3; e < problem.tet_count(); e += 9) gone.push_back(e);
  for (Index e : gone) destroyed[e] = 1;
  pass.destroy(gone);
  expect_same_sums(pass, body, u);
  for (Index e : gone) destroyed[e] = 0;  // taken back
  pass.body_changed();
  expect_same_sums(pass, body, u);
  std::swap(of[0], of[1]);
  destroyed[8] = 1;
  pass.body_changed();
  expect_same_sums(pass, body, u);
}

TEST_F(HyperelasticPassOfABody, HasTheSameBitsForAnyNumberOfThreads) {
  for (std::size_t e = 3; e < destroyed.size(); e += 9) destroyed[e] = 1;
  const HyperelasticBody body{problem, of, destroyed};
  struct Results {
    std::vector<double> f;
    std::vector<Voigt> stress;
    HyperelasticPass::Found found;
  };
  const auto run = [&](int threads) {
    Results all{std::vector<double>(u.size()), std::vector<Voigt>(destroyed.size()), {}};
    HyperelasticPass pass(body, threads);
    all.found = pass.run(u, {.forces = all.f,
                             .stress = all.stress,
                             .measure = StressMeasure::biot,
                             .deformation = true});
    return all;
  };
  const Results one = run(1);
  for (int threads : {2, 3, 7}) {
    const Results same = run(threads);
    EXPECT_EQ(same.f, one.f);
    EXPECT_EQ(same.stress, one.stress);
    EXPECT_EQ(same.found.energy, one.found.energy);
    EXPECT_EQ(same.found.largest, one.found.largest);
    EXPECT_EQ(same.found.deformation.strain, one.found.deformation.strain);
    EXPECT_EQ(same.found.deformation.rotation_deg, one.found.deformation.rotation_deg);
  }
}

TEST_F(HyperelasticPassOfABody, ATurnedBodyBearsNothing) {
  HyperelasticPass pass({problem, of, destroyed}, 1);
  for (double degrees : {30.0, 90.0, 180.0}) {
    const Mat3 r(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3(1, -2, 3).normalized()));
    std::vector<double> turned;
    for (const Vec3& x : problem.mesh().nodes) {
      const Vec3 at = r * x - x;
      turned.insert(turned.end(), at.begin(), at.end());
    }
    std::vector<double> f(turned.size());
    const auto found =
        pass.run(turned, {.forces = f, .measure = StressMeasure::cauchy, .deformation = true});
    for (double x : f) EXPECT_NEAR(x, 0, 1e-13);  // 1e-15 of 20 MPa on areas of a mm^2
    EXPECT_LE(found.largest, 1e-12);
    EXPECT_NEAR(found.deformation.rotation_deg, degrees, 1e-6);
    EXPECT_NEAR(found.deformation.strain, 0, 1e-14);
  }
}

}  // namespace
}  // namespace sunder::fem
