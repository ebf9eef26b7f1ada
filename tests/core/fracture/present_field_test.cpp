// SPDX-License-Identifier: Apache-2.0
// The current body's smoothed field (method.md 5, sigma0 = "present").
#include "fracture/present_field.hpp"

#include "board_fixture.hpp"
#include "body/element.hpp"
#include "fracture/pristine_field.hpp"

namespace sunder::fracture {
namespace {

using test::Driver;
using test::kSlitHeight;

Scene slit(RemoteStress sigma0) {
  Scene scene = test::edge_slit(5);
  scene.fracture.sigma0 = sigma0;
  return scene;
}

/// u_y = x y: stress yy grows with x.
std::vector<double> growing_field(const Mesh& mesh) {
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) u.insert(u.end(), {-x.y() * x.y() / 2, x.x() * x.y(), 0.0});
  return u;
}

PresentField::ReadDisplacement reader(const std::vector<double>& u) {
  return [&u](std::span<const Index> nodes, std::span<Vec3> moved) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      moved[i] = Vec3(u[3 * nodes[i]], u[3 * nodes[i] + 1], u[3 * nodes[i] + 2]);
  };
}

TEST(PresentField, IsTheMeanOverLiveBreakableNeighbours) {
  const Driver driver(slit(RemoteStress::present));
  const Problem& problem = driver.problem;
  const auto u = growing_field(problem.mesh());
  const auto read = reader(u);
  PresentField field(problem, driver.board);
  field.take(driver.destroyed, read);
  const Vec2 p(4.8, kSlitHeight);  // beside destroyed and live elements
  InPlane live = InPlane::Zero(), all = InPlane::Zero();
  double live_volume = 0, all_volume = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if ((driver.board.centroid(e) - p).norm() > 1.5 * driver.board.h()) continue;
    const double volume = problem.shape(e).volume;
    const Voigt s = fem::stress(problem.shape(e), problem.small_strain(e),
                                fem::corner_displacement(problem.mesh(), e, u));
    all += volume * in_plane(s, driver.board.plane());
    all_volume += volume;
    if (driver.destroyed[e]) continue;
    live += volume * in_plane(s, driver.board.plane());
    live_volume += volume;
  }
  ASSERT_LT(live_volume, 0.9 * all_volume);
  ASSERT_GT((live / live_volume - all / all_volume).norm(), 1e-3);
  EXPECT_NEAR((*field.at(p) - live / live_volume).norm(), 0, 1e-13);
}

TEST(PresentField, WithoutDamageItIsThePristineOne) {
  const Driver driver(slit(RemoteStress::present));
  const auto u = growing_field(driver.problem.mesh());
  const auto read = reader(u);
  const std::vector<std::uint8_t> whole(driver.destroyed.size(), 0);
  PresentField present(driver.problem, driver.board);
  present.take(whole, read);
  const PristineField pristine(driver.problem, driver.board, u);
  const Vec2 from(0, kSlitHeight), to(9, 3);
  EXPECT_NEAR((*present.along(from, to) - *pristine.along(from, to)).norm(), 0, 1e-13);
}

TEST(PresentField, WhereAllIsDestroyedThereIsNone) {
  const Driver driver(slit(RemoteStress::present));
  const auto u = growing_field(driver.problem.mesh());
  const auto read = reader(u);
  const std::vector<std::uint8_t> gone(driver.destroyed.size(), 1);
  PresentField field(driver.problem, driver.board);
  field.take(gone, read);
  EXPECT_FALSE(field.along(Vec2(0, kSlitHeight), Vec2(5, kSlitHeight)));
}

/// The criterion asks for the present field when sigma0 says so, and then for no other.
TEST(PresentField, DrivesTheTip) {
  Driver driver(slit(RemoteStress::present));
  const auto u = test::uniform_field(driver.problem.mesh(), test::tension(0.9, 70));
  FractureState state = driver.state();
  state.displacement = reader(u);
  state.pristine_displacement = []() -> std::span<const double> {
    throw std::logic_error("the intact body was not planned");
  };
  Decision decision;
  driver.criterion->decide(state, decision);
  ASSERT_FALSE(decision.elements.empty());
  const SifTerms& k = *decision.elements.front().sif;
  EXPECT_NEAR(k.sigma0, 0.9, 1e-12);
  EXPECT_NEAR(k.beta, 20, 1e-9);
  EXPECT_NEAR(k.theta, -20, 1e-9);
}

}  // namespace
}  // namespace sunder::fracture
