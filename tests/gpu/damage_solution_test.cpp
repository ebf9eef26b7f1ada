// SPDX-License-Identifier: Apache-2.0
// The small matrices of the damage on the device, against the host's solution with them.
#include "gpu/passes/damage_solution.hpp"

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"
#include "kernels_fixture.hpp"
#include "solver/deferred.hpp"
#include "solver/inverse_base.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

class DamageSolutionKernels : public Kernels {};

INSTANTIATE_TEST_SUITE_P(All, DamageSolutionKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::gpu, false},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& info) { return name_of(info.param); });

/// Counts what is asked of it.
class Counted final : public solver::DamageSolver {
 public:
  explicit Counted(gpu::DamageSolution& of) : of_(of) {}
  bool takes(Index columns, Index grips) const override { return of_.takes(columns, grips); }
  void forget() override { of_.forget(); }
  void forget_forces() override { of_.forget_forces(); }
  void change_stiffness(std::span<const Index> rows) override { of_.change_stiffness(rows); }
  bool follows(Index rank, Index columns) override { return of_.follows(rank, columns); }
  void update(const linear_algebra::RowMajor& w, const linear_algebra::RowMajor& v, Index rank,
              Index columns, bool subtract) override {
    ++updates;
    of_.update(w, v, rank, columns, subtract);
  }
  bool wants_grips() const override { return of_.wants_grips(); }
  bool bring(const solver::SmallMatrices& all) override { return of_.bring(all); }
  void solve(const Eigen::VectorXd& p, std::span<const double> displacement,
             std::span<double> energies, Eigen::VectorXd& x) override {
    ++solutions;
    of_.solve(p, displacement, energies, x);
    lacked = energies[0];
  }
  void refine(std::span<double> energies, Eigen::VectorXd& x) override { of_.refine(energies, x); }

  int updates = 0, solutions = 0;
  double lacked = 0;  // before the first refinement of the last solution

 private:
  gpu::DamageSolution& of_;
};

/// The lower edge is held by a grip that pulls.
Scene gripped_board() {
  Scene scene = held_board();
  Instrument grip;
  grip.name = "grip";
  grip.action = Grip{Box{Vec3(20, -0.001, -1), Vec3(51, 0.001, 3)}, Vec3(0.5, -2, 0), Axes{7}};
  scene.instruments.push_back(grip);
  return scene;
}

/// One damage, solved for by the host and by the device.
struct Both {
  explicit Both(Scene scene, gpu::DamageSolution& solution)
      : problem(std::move(scene)),
        factor(fem::factor_stiffness(problem)),
        by_host(problem, std::make_unique<solver::InverseBase>(factor)),
        by_device(problem, std::make_unique<solver::InverseBase>(factor)),
        counted(solution) {
    by_device.solve_by(&counted);
    for (Index n = 0; n < problem.node_count(); ++n) {
      const Vec3& x = problem.mesh().nodes[n];
      const Index d = problem.dof(n, 1);
      if (d == kNone || x.x() > 0.001 || x.y() > 25) continue;
      dofs.push_back(d);
      forces.push_back(-3);
    }
    displacement.assign(problem.gripped_dofs().size(), -0.2);
    if (!displacement.empty()) displacement[0] = 0.3;
  }
  void destroy(std::span<const Index> elements) {
    ASSERT_TRUE(by_host.destroy(elements));
    ASSERT_TRUE(by_device.destroy(elements));
  }
  void follow(const fem::Event& event) {
    ASSERT_TRUE(by_host.follow(event));
    ASSERT_TRUE(by_device.follow(event));
  }
  void take_back(Index events) {
    by_host.take_back(events);
    by_device.take_back(events);
  }
  void expect_agreement(bool there, int line = __builtin_LINE()) {
    SCOPED_TRACE(line);
    const int before = counted.solutions;
    Eigen::VectorXd right, u;
    by_host.solve({dofs, forces}, displacement, right);
    by_device.solve({dofs, forces}, displacement, u);
    EXPECT_EQ(counted.solutions, before + (there ? 1 : 0));
    EXPECT_LE((u - right).norm(), 1e-10 * right.norm());
    double energy = 0;
    for (std::size_t i = 0; i < dofs.size(); ++i) energy += forces[i] * right[dofs[i]];
    for (std::size_t g = 0; g < displacement.size(); ++g)
      energy += by_host.grip_force(g) * displacement[g];
    // Before any refinement: what S and T give by themselves.
    EXPECT_LE(counted.lacked, 1e-21 * std::abs(energy));
    for (std::size_t g = 0; g < displacement.size(); ++g) {
      EXPECT_NEAR(by_device.grip_force(g), by_host.grip_force(g),
                  1e-9 * by_host.grip_forces().cwiseAbs().maxCoeff());
    }
  }
  /// Element by element, each followed by the device; the matrices come after the first.
  void tear(std::span<const Index> elements) {
    destroy(elements.first(1));
    bring();
    for (std::size_t i = 1; i < elements.size(); ++i) {
      SCOPED_TRACE(i);
      destroy(elements.subspan(i, 1));
      expect_agreement(true);
    }
  }
  /// Over the solutions in which the matrices come.
  void bring(int line = __builtin_LINE()) {
    for (const bool there : {false, false, true}) expect_agreement(there, line);
  }

  Problem problem;
  linear_algebra::Factor factor;
  solver::Deferred by_host, by_device;
  Counted counted;
  std::vector<Index> dofs;
  std::vector<double> forces, displacement;
};

void follow_a_tear(Scene scene, gpu::DamageSolution& solution) {
  Both both(std::move(scene), solution);
  const auto crack = crack_sequence(both.problem, 60, 12);
  both.tear(std::span(crack).first(12));
  EXPECT_EQ(both.counted.updates, 11);
  both.expect_agreement(true);
  both.destroy(std::span(crack).subspan(12, 8));
  both.expect_agreement(true);
  both.take_back(2);
  both.bring();
  both.destroy(std::span(crack).subspan(11, 1));
  both.destroy(std::span(crack).subspan(12, 1));  // before a solution
  both.expect_agreement(true);
  const int updates = both.counted.updates;
  both.destroy(std::span(crack).subspan(13, 20));  // some ninety vectors
  EXPECT_EQ(both.counted.updates, updates + 1);
  both.expect_agreement(true);
  for (std::size_t i = 33; i < 43; ++i) both.destroy(std::span(crack).subspan(i, 1));
  EXPECT_LT(both.counted.updates, updates + 11);  // S comes anew
  both.expect_agreement(true);
  auto scattered = scattered_sequence(both.problem, 60);  // more than there is room for
  std::erase_if(scattered, [&](Index e) { return std::ranges::count(crack, e) > 0; });
  both.destroy(std::span(scattered).first(30));
  both.expect_agreement(true);
}

TEST_P(DamageSolutionKernels, FollowATear) {
  gpu::DamageSolution solution(*factory_, 700, 0, 1);
  follow_a_tear(held_board(), solution);
}

TEST_P(DamageSolutionKernels, FollowATearUnderGrips) {
  const auto grips = static_cast<Index>(Problem(gripped_board()).gripped_dofs().size());
  gpu::DamageSolution solution(*factory_, 800, grips, 1);
  follow_a_tear(gripped_board(), solution);
}

TEST_P(DamageSolutionKernels, FollowATearOfWhatGripsAloneHold) {
  Scene scene = gripped_board();
  scene.supports.clear();
  const auto grips = static_cast<Index>(Problem(scene).gripped_dofs().size());
  gpu::DamageSolution solution(*factory_, 800, grips, 1);
  follow_a_tear(scene, solution);
}

// Each event takes the patches' old stiffness and brings the new one.
TEST_P(DamageSolutionKernels, FollowATearOfPooledVolume) {
  Scene scene = gripped_board();
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::pooled;
  const auto grips = static_cast<Index>(Problem(scene).gripped_dofs().size());
  gpu::DamageSolution solution(*factory_, 1500, grips, 1);
  Both both(scene, solution);
  const auto crack = crack_sequence(both.problem, 20, 12);
  both.tear(crack);
  EXPECT_EQ(both.counted.updates, 38);
}

// While the tear goes on, event after event.
TEST_P(DamageSolutionKernels, ComeWhileTheTearGoesOn) {
  const auto grips = static_cast<Index>(Problem(gripped_board()).gripped_dofs().size());
  gpu::DamageSolution solution(*factory_, 400, grips, grips + 20);
  Both both(gripped_board(), solution);
  const auto crack = crack_sequence(both.problem, 60, 12);
  int there = 0;
  for (std::size_t i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    both.destroy(std::span(crack).subspan(i, 1));
    const bool takes = solution.takes(both.by_host.rank(), grips);
    there += takes ? 1 : 0;
    both.expect_agreement(takes && there > 2);
  }
  EXPECT_GT(there, 15);
}

TEST_P(DamageSolutionKernels, FollowHandsThatGraspAndLetGo) {
  Scene scene = gripped_board();
  const auto grips = static_cast<Index>(Problem(gripped_board()).gripped_dofs().size());
  gpu::DamageSolution solution(*factory_, 400, grips + 2, 1);
  Both both(std::move(scene), solution);
  const auto crack = crack_sequence(both.problem, 12, 12);
  both.destroy(crack);
  both.bring();
  const std::vector<Index> grasp{both.dofs[0], both.dofs[0] + 1};
  both.follow({.grasp = grasp});
  both.dofs.erase(both.dofs.begin());
  both.forces.erase(both.forces.begin());
  both.displacement.assign(static_cast<std::size_t>(both.by_host.grips()), -0.1);
  both.expect_agreement(true);
  both.follow({.release = grasp});
  both.displacement.assign(static_cast<std::size_t>(both.by_host.grips()), -0.1);
  both.expect_agreement(true);
}

TEST_P(DamageSolutionKernels, AreTheHostsWhereTheyHaveNoRoom) {
  gpu::DamageSolution solution(*factory_, 64, 0, 30);
  EXPECT_TRUE(solution.takes(64, 0));
  EXPECT_FALSE(solution.takes(29, 0));
  EXPECT_FALSE(solution.takes(65, 0));
  EXPECT_FALSE(solution.takes(40, 1));
  Both both(held_board(), solution);
  const auto crack = crack_sequence(both.problem, 60, 12);
  for (std::size_t i = 0; i < 40; ++i) {
    both.destroy(std::span(crack).subspan(i, 1));
    Eigen::VectorXd right, u;
    both.by_host.solve({both.dofs, both.forces}, {}, right);
    both.by_device.solve({both.dofs, both.forces}, {}, u);
    EXPECT_LE((u - right).norm(), 1e-11 * right.norm());
  }
  EXPECT_GT(both.by_host.rank(), 64);
  EXPECT_GT(both.counted.solutions, 0);
  EXPECT_EQ(solution.bytes(), gpu::DamageSolution::planned_bytes(64, 0));
}

// Of matrices that belong to no body, so that every refinement changes much: x and its energies are
// those of damage_solver.hpp's formulas.
TEST_P(DamageSolutionKernels, AreThoseOfTheFormulas) {
  constexpr Index n = 85, g = 7;
  using Eigen::MatrixXd, Eigen::VectorXd;
  using linear_algebra::RowMajor;
  const auto any = [&](Eigen::Index rows, Eigen::Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return uniform_(generator_); }));
  };
  const auto symmetric = [&] {
    const MatrixXd a = any(n, n);
    return RowMajor(0.1 * (a + a.transpose()));
  };
  const RowMajor compliance = symmetric(), m = symmetric(), d = symmetric(), t = any(g, n),
                 of_grips = 0.1 * any(g, n);
  const std::vector<Index> held{3, 1, 40, 64, 80, 2, 84}, only_grips{1, 64, 84};
  const VectorXd p = any(n, 1), displacement = any(g, 1);
  gpu::DamageSolution solution(*factory_, n + 5, g + 2, 1);
  const solver::SmallMatrices all{n, &compliance, &m, &d, held, only_grips, &t, &of_grips};
  for (const bool there : {false, false, true}) EXPECT_EQ(solution.bring(all), there);
  std::array<double, 3> energies{};
  VectorXd x(n);
  solution.solve(p, std::span(displacement.data(), g), energies, x);

  const MatrixXd s = m - of_grips.transpose() * of_grips;
  VectorXd right = t.transpose() * displacement + s * p;
  const auto refine = [&] {
    const VectorXd v = p + compliance * right;
    VectorXd lack = d * v - right, missing(g);
    for (const Index i : only_grips) lack(i) = 0;
    for (Index i = 0; i < g; ++i) missing(i) = displacement(i) - v(held[i]);
    const VectorXd of_lack = compliance * lack;
    right += lack + t.transpose() * missing + s * of_lack;
    return lack.dot(of_lack) + of_lack.dot(s * of_lack);
  };
  for (const double energy : energies) {
    const double expected = refine();
    EXPECT_NEAR(energy, expected, 1e-10 * std::abs(expected));
  }
  EXPECT_LE((x - right).norm(), 1e-12 * right.norm());
  std::array<double, 1> more{};
  solution.refine(more, x);
  const double expected = refine();
  EXPECT_NEAR(more[0], expected, 1e-10 * std::abs(expected));
  EXPECT_LE((x - right).norm(), 1e-12 * right.norm());
}

}  // namespace
}  // namespace sunder::test
