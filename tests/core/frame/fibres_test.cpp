// SPDX-License-Identifier: Apache-2.0
// Scenes with fibres: blocks against closed forms of an incompressible matrix, transversely
// isotropic elasticity by the tests that define its constants.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cpu_reference/cpu_reference.hpp"
#include "fibre_cubes.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr double kInReach = 0.01;  // of the incompressible limit

std::vector<Voigt> stress_of(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!run.done()) run.step();
  return run.stress();
}

/// W' of a family by E.
double slope_of_energy(double e) { return e > 0 ? kK1 * e * std::exp(kK2 * e * e) : 0; }

/// Where a function that grows is 0.
template <class Function>
double root(double low, double high, const Function& of) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (of(middle) < 0 ? low : high) = middle;
  }
  return low;
}

struct Pulled {
  std::vector<double> degrees;
  double dispersion = 0;
};

/// Cauchy stress of diag(l1, l2, 1/(l1 l2)) without stress along z: Holzapfel, Gasser and Ogden
/// 2000 with an incompressible matrix, s = mu (b - l3^2 I) + sum 2 W' (F A F^T - (F A F^T)_zz I).
Mat3 closed_form(const Pulled& of, double l1, double l2) {
  const Vec3 l(l1, l2, 1 / (l1 * l2));
  const Mat3 f = l.asDiagonal();
  Mat3 s = kMu * f * f;
  for (const double degrees : of.degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 a(std::cos(angle), std::sin(angle), 0);
    const Mat3 structure =
        of.dispersion * Mat3::Identity() + (1 - 3 * of.dispersion) * a * a.transpose();
    const Mat3 faf = f * structure * f;
    s += 2 * slope_of_energy(faf.trace() - 1) * faf;
  }
  return s - s(2, 2) * Mat3::Identity();
}

void expect_near(const std::vector<Voigt>& found, const Mat3& expected) {
  for (const Voigt& s : found) {
    Mat3 t;
    t << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    EXPECT_LT((t - expected).norm(), kInReach * expected.norm()) << t << "\n\n" << expected;
  }
}

Scene with(const Pulled& of) {
  Scene scene = cube();
  for (const double degrees : of.degrees) {
    scene.materials["board"].fibres.push_back(at_angle(degrees, of.dispersion));
  }
  return scene;
}

// Along, across (where fibres are slack), and two families at 45 degrees to both sides.
TEST(Fibres, UniaxialTensionAgainstTheClosedForm) {
  for (const Pulled& of : {Pulled{{0}}, Pulled{{90}}, Pulled{{45, -45}}, Pulled{{0, 90}},
                           Pulled{{0}, 0.1}, Pulled{{45, -45}, 0.2}}) {
    SCOPED_TRACE(testing::PrintToString(of.degrees) + " " + std::to_string(of.dispersion));
    const double l1 = 1.25;
    const double l2 = root(0.5, 1.2, [&](double l) { return closed_form(of, l1, l)(1, 1); });
    Scene scene = with(of);
    hold(scene);
    pull(scene, 0, l1);
    expect_near(stress_of(std::move(scene)), closed_form(of, l1, l2));
  }
}

/// Of an incompressible block, F = [[l, g, 0], [0, m, 0], [0, 0, 1/(l m)]]: what a dead load along
/// x alone makes of it, as moments balance only where x stays along x. g and m by least energy.
struct Slid {
  double l, g, m;
  [[nodiscard]] Mat3 gradient() const {
    Mat3 f = Vec3(l, m, 1 / (l * m)).asDiagonal();
    f(0, 1) = g;
    return f;
  }
};
double energy_of(const Slid& at, const Pulled& of) {
  const Mat3 f = at.gradient();
  double w = kMu / 2 * f.squaredNorm();
  for (const double degrees : of.degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const double e = (f * Vec3(std::cos(angle), std::sin(angle), 0)).squaredNorm() - 1;
    if (e > 0) w += kK1 / (2 * kK2) * std::expm1(kK2 * e * e);
  }
  return w;
}
double slope(const std::function<double(double)>& of, double h = 1e-4) {
  return (8 * (of(h) - of(-h)) - (of(2 * h) - of(-2 * h))) / (12 * h);
}
Slid least_energy(double l, const Pulled& of) {
  const auto best = [&](double m) {  // W is convex in g
    return root(-1, 1, [&](double g) {
      return slope([&](double h) { return energy_of({l, g + h, m}, of); });
    });
  };
  const double m = root(0.5, 1.2, [&](double at) {
    return slope([&](double h) { return energy_of({l, best(at), at + h}, of); });
  });
  return {l, best(m), m};
}

/// A dead load of so much stress on the ends x = 0 and x = 4, an instrument a node by its share of
/// the area; what is left is a body that may move as one, held at three corners.
void load_ends(Scene& scene, double stress) {
  const Mesh& mesh = scene.mesh;
  std::vector<double> share(mesh.nodes.size(), 0);
  for (const auto& tet : mesh.tets) {
    for (const double end : {0.0, 4.0}) {
      std::vector<Index> on;
      for (const Index n : tet) {
        if (std::abs(mesh.nodes[static_cast<std::size_t>(n)].x() - end) < 1e-9) on.push_back(n);
      }
      if (on.size() != 3) continue;
      const auto at = [&](std::size_t i) { return mesh.nodes[static_cast<std::size_t>(on[i])]; };
      const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
      for (const Index n : on) share[static_cast<std::size_t>(n)] += (end > 0 ? 1 : -1) * area / 3;
    }
  }
  for (std::size_t n = 0; n < share.size(); ++n) {
    if (share[n] == 0 || mesh.nodes[n].isZero()) continue;  // the origin is held
    Instrument tool;
    tool.name = std::to_string(n);
    tool.action = Pull{std::vector<Index>{static_cast<Index>(n)}, Vec3(stress * share[n], 0, 0)};
    scene.instruments.push_back(tool);
  }
  const auto corner = [](double x, double y) {
    return Box{Vec3(x - 1e-6, y - 1e-6, -1e-6), Vec3(x + 1e-6, y + 1e-6, 1e-6)};
  };
  scene.supports.push_back({corner(0, 0), Axes{7}});
  scene.supports.push_back({corner(4, 0), Axes{6}});
  scene.supports.push_back({corner(0, 4), Axes{4}});
}

// One family at 45 degrees to the pull slides the block along itself.
TEST(Fibres, AnObliqueFamilyShearsTheBlock) {
  const Pulled of{{45}};
  const Slid at = least_energy(1.2, of);
  EXPECT_GT(std::abs(at.g), 0.05);
  const double nominal = slope([&](double h) { return energy_of({at.l + h, at.g, at.m}, of); });
  Scene scene = with(of);
  load_ends(scene, nominal);
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!run.done()) run.step();
  const auto stress = run.stress();
  for (const Voigt& s : stress) {
    EXPECT_NEAR(s[0], nominal * at.l, kInReach * nominal * at.l);
    EXPECT_LT(s.tail<5>().norm(), kInReach * nominal);
  }
  const auto u = run.displacement();
  for (std::size_t n = 0; n < u.size(); ++n) {
    const Vec3 x = problem->mesh().nodes[n];
    EXPECT_LT((u[n] - (at.gradient() * x - x)).norm(), kInReach * 4 * (at.l - 1));
  }
}

// Patches share the matrix's volume and never what fibres bear: in states that are the same
// everywhere nothing tells them apart.
TEST(Fibres, PooledVolumeBearsTheSame) {
  Scene scene = with({{45, -45}, 0.1}), pooled = scene;
  pooled.materials["board"].volume = MaterialVolume::pooled;
  for (Scene* s : {&scene, &pooled}) {
    hold(*s);
    pull(*s, 0, 1.25);
  }
  const auto found = stress_of(std::move(pooled)), alone = stress_of(std::move(scene));
  for (std::size_t e = 0; e < found.size(); ++e) {
    EXPECT_LT((found[e] - alone[e]).norm(), 1e-5 * alone[e].norm());
  }
}

// Fibres across that are pulled against are slack: bit by bit the matrix alone.
TEST(Fibres, PressedFibresBearNothing) {
  Scene scene = with({{0}}), plain = with({});
  for (Scene* s : {&scene, &plain}) {
    hold(*s);
    pull(*s, 0, 0.8);
  }
  const auto found = stress_of(std::move(scene)), alone = stress_of(std::move(plain));
  for (std::size_t e = 0; e < found.size(); ++e) {
    EXPECT_LT((found[e] - alone[e]).norm(), 1e-6 * alone[e].norm());
  }
}

// One family and two, along, across and at 45 degrees. Sides are held straight: a single oblique
// family would shear the block.
TEST(Fibres, BiaxialTensionAgainstTheClosedForm) {
  for (const Pulled& of :
       {Pulled{{0}}, Pulled{{90}}, Pulled{{45}}, Pulled{{45, -45}}, Pulled{{30, -30}, 0.15}}) {
    SCOPED_TRACE(testing::PrintToString(of.degrees) + " " + std::to_string(of.dispersion));
    for (const auto& [l1, l2] : {std::pair(1.15, 1.15), std::pair(1.25, 1 / std::sqrt(1.25))}) {
      Scene scene = with(of);
      scene.supports.push_back({face(2, 0), only(2)});
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {  // every node keeps to its place in the plane
          const Vec3 at(2 * i, 2 * j, 0);
          Instrument tool;
          tool.name = std::to_string(3 * i + j);
          tool.action = Grip{Box{at - Vec3(1e-6, 1e-6, 1), at + Vec3(1e-6, 1e-6, 9)},
                             Vec3((l1 - 1) * at.x(), (l2 - 1) * at.y(), 0), Axes{3}};
          scene.instruments.push_back(tool);
        }
      }
      expect_near(stress_of(std::move(scene)), closed_form(of, l1, l2));
    }
  }
}

// E and nu along and across as they are measured.
TEST(LinearFibres, UniaxialTensionGivesTheModuli) {
  for (const int fibres_along : {0, 1, 2}) {
    for (const int axis : {0, 1, 2}) {
      Scene scene = linear_cube();
      scene.materials["board"].fibres[0].direction = Vec3(7 * Vec3::Unit(fibres_along));
      pull(scene, axis, 1.001);
      const auto problem = std::make_shared<const Problem>(std::move(scene));
      Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
      run.step();
      const double modulus = axis == fibres_along ? 20 : 2;
      for (const Voigt& s : run.stress()) EXPECT_NEAR(s[axis], modulus * 1e-3, 1e-9);
      for (int side = 0; side < 3; ++side) {
        if (side == axis) continue;
        const double nu = axis == fibres_along   ? 0.28
                          : side == fibres_along ? 0.28 * 2 / 20  // nu_tl = nu_lt E_t / E_l
                                                 : 0.35;
        const Vec3 corner = run.displacement().back();
        EXPECT_NEAR(corner[side], -nu * 4e-3, 1e-9) << fibres_along << axis << side;
      }
    }
  }
}

// Events take a fibred element out as a fresh body without it says.
TEST(LinearFibres, ARemovalIsThatOfAFreshBody) {
  const auto scene_of = [](int step) {
    Scene scene = linear_cube();
    scene.materials["board"].fibres[0].direction = Vec3(1, 1, 0);
    pull(scene, 0, 1.01);
    scene.steps = step + 1;
    scene.removals.push_back({step, std::vector<Index>{0, 7, 20}});
    return scene;
  };
  const auto late = stress_of(scene_of(2)), early = stress_of(scene_of(0));
  double most = 0;
  for (const Voigt& s : early) most = std::max(most, s.norm());
  for (std::size_t e = 0; e < late.size(); ++e) EXPECT_LT((late[e] - early[e]).norm(), 1e-6 * most);
}

TEST(LinearFibres, NothingIsAttributed) {
  const auto problem = std::make_shared<const Problem>(linear_cube());
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  try {
    run.attribute_events(true);
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_TRUE(mentions(error.what(), "attribution knows isotropic elements alone"))
        << error.what();
  }
}

// Motion that is damped ends where statics is.
TEST(Fibres, MoveAndRest) {
  for (const bool linear : {false, true}) {
    Scene scene = linear ? linear_cube() : with({{45, -45}});
    if (!linear) hold(scene);
    scene.materials["board"].density = 1e-9;
    scene.dynamics = Dynamics{};
    scene.dynamics->time_step = 1e-4;
    scene.dynamics->mass_damping = 4000;
    scene.steps = 150;
    pull(scene, 0, 1.05);
    Scene resting = scene;
    resting.dynamics.reset();
    const auto moved = stress_of(std::move(scene)), rested = stress_of(std::move(resting));
    for (std::size_t e = 0; e < moved.size(); ++e) {
      EXPECT_LT((moved[e] - rested[e]).norm(), 0.01 * rested[e].norm());
    }
  }
}

TEST(Fibres, RunRoundAnAxis) {
  Scene scene = with({{0}});
  scene.materials["board"].fibres[0].direction = AroundAxis{Vec3(-3, 1, 2), Vec3(0, 0, 4)};
  hold(scene);
  const Problem problem(scene);
  ASSERT_TRUE(problem.fibrous());
  EXPECT_EQ(problem.fibre_families(), 1);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    Vec3 centroid = Vec3::Zero();
    for (const Index n : problem.mesh().tets[e]) centroid += problem.mesh().nodes[n] / 4;
    const Vec3 way = centroid - Vec3(-3, 1, 2);
    const Vec3 expected = Vec3(-way.y(), way.x(), 0).normalized();
    EXPECT_LT((problem.fibre_direction(e, 0) - expected).norm(), 1e-14);
  }
}

// A right angle: each element takes the leg that it is nearer to.
TEST(Fibres, RunAlongACurve) {
  Scene scene = with({{0}});
  scene.materials["board"].fibres[0].direction =
      AlongCurve{{Vec3(-1, -0.5, 1), Vec3(1, -0.5, 1), Vec3(3, -0.5, 1), Vec3(3, 7, 8)}};
  hold(scene);
  const Problem problem(scene);
  int turned = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    Vec3 x = Vec3::Zero();
    for (const Index n : problem.mesh().tets[e]) x += problem.mesh().nodes[n] / 4;
    const double first = std::hypot(std::max(x.x() - 3, 0.0), x.y() + 0.5, x.z() - 1);
    const double at = std::clamp((x - Vec3(3, -0.5, 1)).dot(Vec3(0, 7.5, 7)) / 105.25, 0.0, 1.0);
    const double last = (x - Vec3(3, -0.5, 1) - at * Vec3(0, 7.5, 7)).norm();
    const Vec3 expected = first <= last ? Vec3(1, 0, 0) : Vec3(0, 7.5, 7).normalized();
    turned += first <= last ? 0 : 1;
    EXPECT_LT((problem.fibre_direction(e, 0) - expected).norm(), 1e-14) << e;
  }
  EXPECT_GT(turned, 0);
  EXPECT_LT(turned, problem.tet_count());
}

// Along a tilted plane and a level one: less the part across the nearer triangle.
TEST(Fibres, RunAlongASurface) {
  Scene scene = with({{0}});
  const auto at = [&](const Vec3& x) {
    scene.mesh.nodes.push_back(x);
    return scene.mesh.node_count() - 1;
  };
  NamedSurface surface{"skin", 7, {}};
  const Vec3 tilted = Vec3(0, -1, 1).normalized();
  surface.triangles.push_back({at(Vec3(0, -1, 3)), at(Vec3(4, -1, 3)), at(Vec3(2, 1, 5))});
  surface.triangles.push_back({at(Vec3(0, 2, -1)), at(Vec3(4, 2, -1)), at(Vec3(2, 4, -1))});
  scene.mesh.surfaces.push_back(surface);
  const Vec3 along(1, 2, -0.5);
  scene.materials["board"].fibres[0].direction = AlongSurface{"skin", along};
  hold(scene);
  const Problem problem(scene);
  int of_first = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    Vec3 x = Vec3::Zero();
    for (const Index n : problem.mesh().tets[e]) x += problem.mesh().nodes[n] / 4;
    const bool first = (x - Vec3(2, -1.0 / 3, 11.0 / 3)).norm() < (x - Vec3(2, 8.0 / 3, -1)).norm();
    const Vec3 normal = first ? tilted : Vec3(0, 0, 1);
    of_first += first ? 1 : 0;
    const Vec3 expected = (along - normal.dot(along) * normal).normalized();
    EXPECT_LT((problem.fibre_direction(e, 0) - expected).norm(), 1e-14) << e;
  }
  EXPECT_GT(of_first, 0);
  EXPECT_LT(of_first, problem.tet_count());
}

TEST(Fibres, RunAsAFieldSays) {
  Scene scene = with({{0}});
  scene.materials["board"].fibres[0].direction = FieldName{"fibres"};
  hold(scene);
  for (Index e = 0; e < scene.mesh.tet_count(); ++e) {
    scene.mesh.fields["fibres"].push_back(Vec3(0, 2, e));
  }
  const Problem problem(scene);
  EXPECT_LT((problem.fibre_direction(3, 0) - Vec3(0, 2, 3) / std::sqrt(13.0)).norm(), 1e-15);
}

}  // namespace
}  // namespace sunder::test
