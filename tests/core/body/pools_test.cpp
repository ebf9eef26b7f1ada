// SPDX-License-Identifier: Apache-2.0
// Patches of pooled volume: what they are, and the stiffness by its formula.
#include "body/pools.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "body/assembly.hpp"
#include "sunder/error.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"

namespace sunder::fem {
namespace {

constexpr double kNu = 0.4999;

Scene pooled(Mesh mesh, double nu = kNu) {
  Scene scene;
  scene.mesh = std::move(mesh);
  for (const NamedVolume& v : scene.mesh.volumes) {
    scene.materials[v.name] = {5, nu, 1.0};
    scene.materials[v.name].volume = MaterialVolume::pooled;
  }
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-9, 99, 99)}, Axes{7}});
  return scene;
}

Scene board() {
  Scene scene = test::held_board();
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  return scene;
}

/// Elements of the patch that hang together by faces with its first.
std::size_t connected(const Mesh& mesh, std::span<const Index> patch) {
  std::vector<Index> reached{patch[0]};
  const auto share_face = [&mesh](Index a, Index b) {
    int common = 0;
    for (Index n : mesh.tets[static_cast<std::size_t>(a)]) {
      const auto& other = mesh.tets[static_cast<std::size_t>(b)];
      common += std::ranges::find(other, n) != other.end() ? 1 : 0;
    }
    return common == 3;
  };
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (Index e : patch) {
      if (std::ranges::find(reached, e) != reached.end() || !share_face(reached[i], e)) continue;
      reached.push_back(e);
    }
  }
  return reached.size();
}

TEST(Pools, TakeEveryElementOnceInConnectedPatchesOfOneVolume) {
  const Problem problem(board());
  const Pools& pools = *problem.pools();
  std::vector<int> taken(problem.mesh().tets.size(), 0);
  std::size_t most = 0;
  for (Index p = 0; p < pools.count(); ++p) {
    const auto patch = pools.elements(p);
    EXPECT_GE(patch.size(), Pools::kFewest);
    EXPECT_EQ(connected(problem.mesh(), patch), patch.size());
    most = std::max(most, patch.size());
    std::set<Index> volumes;
    for (Index e : patch) {
      ++taken[static_cast<std::size_t>(e)];
      EXPECT_EQ(pools.of(e), p);
      volumes.insert(problem.mesh().volume_of[static_cast<std::size_t>(e)]);
    }
    EXPECT_EQ(volumes.size(), 1U);
  }
  EXPECT_TRUE(std::ranges::all_of(taken, [](int n) { return n == 1; }));
  EXPECT_LE(most, 2 * Pools::kSize);
  EXPECT_EQ(pools.small_count(), 0);
  const double mean = static_cast<double>(taken.size()) / static_cast<double>(pools.count());
  EXPECT_NEAR(mean, static_cast<double>(Pools::kSize), 1.0);
}

TEST(Pools, LeaveOtherMaterialsAlone) {
  Scene scene = test::held_board();
  scene.materials["lower"].volume = MaterialVolume::pooled;
  const Problem problem(scene);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto volume =
        static_cast<std::size_t>(problem.mesh().volume_of[static_cast<std::size_t>(e)]);
    EXPECT_EQ(problem.pools()->of(e) != kNone, problem.mesh().volumes[volume].name == "lower");
  }
  EXPECT_EQ(Problem(test::held_board()).pools(), nullptr);
}

TEST(Pools, PiecesOfFewElementsAreOnePatchEachAndWarnedAbout) {
  Mesh mesh = test::structured_board({1, 1, 1, 1, 1, 1});
  mesh.tets.resize(3);
  mesh.volume_of.resize(3);
  std::vector<Index> used;
  for (auto& tet : mesh.tets) used.insert(used.end(), tet.begin(), tet.end());
  const Problem problem(pooled(mesh));
  ASSERT_LE(problem.pools()->count(), 3);
  std::size_t all = 0;
  for (Index p = 0; p < problem.pools()->count(); ++p) all += problem.pools()->elements(p).size();
  EXPECT_EQ(all, 3U);
  EXPECT_TRUE(std::ranges::any_of(problem.warnings(), [](const std::string& warning) {
    return warning.find("of pooled volume of fewer than 4 elements") != std::string::npos;
  }));
}

/// K over all 3 * nodes by the formula, no supports.
Eigen::MatrixXd by_formula(const Problem& problem, std::span<const double> scale) {
  const Index n = 3 * problem.node_count();
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  const double mu = 5 / (2 * (1 + kNu)), kappa = 5 / (3 * (1 - 2 * kNu));
  for (Index p = 0; p < problem.pools()->count(); ++p) {
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    double volume = 0;
    for (Index e : problem.pools()->elements(p)) {
      const TetShape& shape = problem.shape(e);
      const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
      const double weight = scale[static_cast<std::size_t>(e)] * shape.volume;
      volume += weight;
      for (int i = 0; i < 4; ++i) {
        const Vec3 g = shape.gradient.col(i);
        b.segment<3>(3 * tet[static_cast<std::size_t>(i)]) += weight * g;
        for (int j = 0; j < 4; ++j) {
          const Vec3 h = shape.gradient.col(j);
          k.block<3, 3>(3 * tet[static_cast<std::size_t>(i)],
                        3 * tet[static_cast<std::size_t>(j)]) +=
              weight * mu *
              (g.dot(h) * Mat3::Identity() + h * g.transpose() - 2.0 / 3 * g * h.transpose());
        }
      }
    }
    k += kappa / volume * b * b.transpose();
  }
  return k;
}

std::vector<double> some_shares(const Problem& problem) {
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (std::size_t e = 5; e < scale.size(); e += 7) scale[e] = 1e-6;
  for (Index e : problem.pools()->elements(1)) scale[static_cast<std::size_t>(e)] = 1e-6;
  return scale;
}

TEST(Pools, StiffnessIsThatOfTheFormula) {
  const Problem problem(pooled(test::structured_board({3, 3, 2, 3, 3, 2})));
  const std::vector<double> scale = some_shares(problem);
  const Eigen::MatrixXd k = by_formula(problem, scale);
  const Eigen::MatrixXd lower(assemble_lower(problem, scale));
  double worst = 0;
  std::vector<double> u(problem.dofs().size()), y(u.size());
  for (std::size_t i = 0; i < u.size(); ++i) {
    for (std::size_t j = 0; j < u.size(); ++j) {
      const Index row = problem.dofs()[i], column = problem.dofs()[j];
      if (row == kNone || column == kNone || row < column) continue;
      worst = std::max(
          worst, std::abs(lower(row, column) - k(static_cast<Index>(i), static_cast<Index>(j))));
    }
  }
  EXPECT_LE(worst, 1e-14 * k.cwiseAbs().maxCoeff());
  // The same product element by element, supports included.
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::sin(static_cast<double>(i));
  apply_stiffness(problem, scale, u, y);
  const Eigen::Map<const Eigen::VectorXd> x(u.data(), static_cast<Index>(u.size()));
  const Eigen::VectorXd expected = k * x;
  for (std::size_t i = 0; i < y.size(); ++i) {
    EXPECT_NEAR(y[i], expected[static_cast<Index>(i)], 1e-13 * expected.cwiseAbs().maxCoeff());
  }
}

TEST(Pools, FreeBodyHasSixModesWithoutEnergy) {
  const Problem problem(pooled(test::structured_board({2, 2, 2, 2, 2, 2})));
  const auto n = static_cast<Index>(problem.dofs().size());
  Eigen::MatrixXd k(n, n);
  std::vector<double> u(problem.dofs().size(), 0.0), y(u.size());
  for (Index j = 0; j < n; ++j) {
    u[static_cast<std::size_t>(j)] = 1;
    apply_stiffness(problem, {}, u, y);
    u[static_cast<std::size_t>(j)] = 0;
    k.col(j) = Eigen::Map<const Eigen::VectorXd>(y.data(), n);
  }
  EXPECT_LE((k - k.transpose()).norm(), 1e-13 * k.norm());
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k, Eigen::EigenvaluesOnly).eigenvalues();
  const double rounding = 1e-14 * values[n - 1];
  EXPECT_LE(values.head(6).cwiseAbs().maxCoeff(), rounding);
  EXPECT_GE(values[6], 0.01);  // mu 1.67, edges of 1 mm
}

TEST(Pools, EvenStrainIsEvenStress) {
  const Problem problem(board());
  Mat3 h;
  h << 1e-3, 2e-3, -1e-3, 5e-4, -2e-3, 3e-3, 1e-3, 4e-3, 2e-3;
  std::vector<double> u;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 v = h * x;
    u.insert(u.end(), {v.x(), v.y(), v.z()});
  }
  const StressField field(problem, {}, u);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Voigt s = stress(problem.small_strain(e), h);
    EXPECT_LE((field.of(e) - s).norm(), 1e-12 * s.norm()) << e;
  }
}

std::string refusal(const Scene& scene) {
  try {
    const Problem problem(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Pools, AreThereForEveryLawAtRestAndInMotion) {
  for (MaterialLaw law : {MaterialLaw::linear, MaterialLaw::corotated, MaterialLaw::neo_hookean,
                          MaterialLaw::saint_venant_kirchhoff}) {
    Scene scene = board();
    scene.materials["upper"].law = law;  // beside the linear one
    EXPECT_EQ(refusal(scene), "");
    for (auto& [name, material] : scene.materials) {
      material.law = law;
      material.density = 1e-9;
    }
    EXPECT_EQ(refusal(scene), "");
    scene.dynamics = Dynamics{0.001};
    EXPECT_EQ(refusal(scene), "");
  }
  for (const CrackWay way : {CrackWay::destroyed, CrackWay::split}) {
    Scene cracks = board();
    cracks.fracture.model = FractureModel::b;
    cracks.fracture.crack = way;
    EXPECT_EQ(refusal(cracks), "");
  }
}

/// A board parted along a plane through its patches: the parts of each on either side are patches.
TEST(Pools, APatchIsSplitWhereItsElementsNoLongerHangTogether) {
  const Problem whole(pooled(test::structured_board({7, 5, 3, 7, 5, 3})));
  constexpr double kPlane = 3;
  const auto is_above = [&](Index e) {
    double y = 0;
    for (Index n : whole.mesh().tets[static_cast<std::size_t>(e)]) {
      y += whole.mesh().nodes[static_cast<std::size_t>(n)].y() / 4;
    }
    return y > kPlane;
  };
  std::vector<std::array<Index, 4>> corners = whole.mesh().tets;
  for (Index e = 0; e < whole.tet_count(); ++e) {
    for (Index& n : corners[static_cast<std::size_t>(e)]) {
      const bool on_plane = whole.mesh().nodes[static_cast<std::size_t>(n)].y() == kPlane;
      if (on_plane && is_above(e)) n += whole.node_count();
    }
  }
  const Pools& was = *whole.pools();
  const auto parted = parted_pools(whole, pools_of(whole), corners);
  int split = 0;
  for (Index p = 0; p < was.count(); ++p) {
    const auto elements = was.elements(p);
    const auto above = std::ranges::count_if(elements, is_above);
    if (above > 0 && above < static_cast<std::ptrdiff_t>(elements.size())) {
      ++split;
    } else {
      EXPECT_TRUE(std::ranges::equal(elements, parted->elements(p))) << p;
    }
  }
  EXPECT_GT(split, 2);
  EXPECT_GE(parted->count(), was.count() + split);
  std::size_t all = 0;
  for (Index p = 0; p < parted->count(); ++p) {
    const auto elements = parted->elements(p);
    all += elements.size();
    for (Index e : elements) {
      EXPECT_EQ(parted->of(e), p);
      EXPECT_EQ(is_above(e), is_above(elements.front())) << p;
      EXPECT_EQ(was.of(e), was.of(elements.front())) << p;
    }
    EXPECT_EQ(parted->bulk(p), was.bulk(was.of(elements.front())));
  }
  EXPECT_EQ(all, whole.mesh().tets.size());
}

// The body of a patch's first element keeps its number, what belongs to none stays there too.
TEST(Pools, AreSplitByTheBodiesOfTheirElements) {
  const Problem problem(board());
  const Pools& whole = *problem.pools();
  EXPECT_EQ(whole.split([](Index) { return 3; }), nullptr);
  const auto first = whole.elements(1);
  const std::vector<Index> members(first.begin(), first.end());
  ASSERT_GE(members.size(), 4U);
  const auto split = whole.split([&](Index e) {
    if (whole.of(e) != 1) return 0;
    if (e == members[1]) return kNone;
    return e == members[2] ? 7 : e == members[3] ? 5 : 0;
  });
  ASSERT_TRUE(split);
  EXPECT_EQ(split->count(), whole.count() + 2);
  EXPECT_EQ(split->of(members[0]), 1);
  EXPECT_EQ(split->of(members[1]), 1);
  EXPECT_EQ(split->of(members[2]), whole.count());
  EXPECT_EQ(split->of(members[3]), whole.count() + 1);
  EXPECT_EQ(split->bulk(whole.count()), whole.bulk(1));
  EXPECT_FALSE(*split == whole);
}

bool warns_of_locking(double nu, MaterialVolume volume) {
  Scene scene = test::held_board();
  test::set_poisson(scene, nu);
  for (auto& [name, material] : scene.materials) material.volume = volume;
  const Problem problem(scene);
  return std::ranges::any_of(problem.warnings(), [](const std::string& warning) {
    return warning.find("linear tetrahedra lock over 0.49") != std::string::npos;
  });
}

TEST(Pools, VolumeByElementIsWarnedAboutWhereItLocks) {
  EXPECT_FALSE(warns_of_locking(0.49, MaterialVolume::element));
  EXPECT_TRUE(warns_of_locking(0.491, MaterialVolume::element));
  EXPECT_FALSE(warns_of_locking(0.4999, MaterialVolume::pooled));
}

}  // namespace
}  // namespace sunder::fem
