// SPDX-License-Identifier: Apache-2.0
// Symmetric meshes under symmetric loads stay symmetric along split cracks, whole runs.
#include <map>

#include "measured_split.hpp"

namespace sunder {
namespace {

using test::kFar;

/// Largest difference between displacement and its image, by the corners of elements, which lips
/// do not share; relative to the largest displacement.
double asymmetry(const Simulation& run, int axis) {
  const Mesh mesh = run.mesh();
  const std::vector<Vec3> u = run.displacement();
  const std::size_t half = mesh.tets.size() / 2;
  constexpr std::array<std::size_t, 4> kImage{0, 1, 3, 2};
  double worst = 0, largest = 0;
  for (std::size_t e = 0; e < half; ++e) {
    if (run.backend().destroyed()[e]) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      const Vec3& here = u[static_cast<std::size_t>(mesh.tets[e][a])];
      Vec3 there = u[static_cast<std::size_t>(mesh.tets[e + half][kImage[a]])];
      there[axis] = -there[axis];
      worst = std::max(worst, (here - there).norm());
      largest = std::max(largest, here.norm());
    }
  }
  return worst / largest;
}

PresetCrack notch(const Box& elements, const Vec3& mouth, const Vec3& tip) {
  PresetCrack crack;
  crack.elements = elements;
  crack.mouth = mouth;
  crack.tips = {tip};
  return crack;
}

Scene torn(Mesh mesh, double poisson) {
  Scene scene;
  scene.mesh = std::move(mesh);
  scene.materials["board"] = {5, poisson, std::nullopt};
  scene.materials["board"].toughness = 1;
  scene.fracture.model = FractureModel::b;
  scene.fracture.crack = CrackWay::split;
  scene.fracture.sif = SifSource::field;
  scene.fracture.max_events = 1;
  scene.solver.route = Route::factor;
  scene.supports.push_back({Box{Vec3(-kFar, -kFar, -kFar), Vec3(kFar, kFar, kFar)}, Axes{4}});
  scene.steps = 12;
  return scene;
}

/// Pulls a slab of nodes.
Instrument pull(const char* name, const Box& box, const Vec3& force) {
  return {name, Pull{box, force}, {}};
}

/// As long as cracks grow, at most so many steps; how many growths there were.
int tear(Simulation& run, int axis, std::size_t cracks) {
  int grown = 0;
  while (!run.done()) {
    const StepReport report = run.step();
    EXPECT_LE(asymmetry(run, axis), 1e-9) << "step " << report.step;
    if (::testing::Test::HasFailure()) return grown;
    const auto& tips = run.cracks();
    EXPECT_EQ(tips.size(), cracks);
    if (tips[0].tips[0].ended) break;
  }
  for (const DestroyedElement& row : run.destroyed()) grown += row.lives;
  return grown;
}

/// The mirror is the crack's own plane, which is one of faces.
TEST(SplitSymmetry, ACrackAlongTheMirrorStaysInIt) {
  Mesh half = test::structured_board({24, 10, 1, 24, 10, 1});
  Scene scene = torn(test::with_image(half, 1, 10), 0.3);
  scene.supports.push_back(
      {Box{Vec3(24 - 1e-9, 10 - 1e-9, -kFar), Vec3(kFar, 10 + 1e-9, kFar)}, Axes{3}});
  for (double y : {0.0, 20.0}) {
    scene.supports.push_back(
        {Box{Vec3(24 - 1e-9, y - 1e-9, -kFar), Vec3(kFar, y + 1e-9, kFar)}, Axes{1}});
  }
  scene.instruments = {
      pull("up", {Vec3(-kFar, 20 - 1e-9, -kFar), Vec3(23, kFar, kFar)}, Vec3(0, 20, 0)),
      pull("down", {Vec3(-kFar, -kFar, -kFar), Vec3(23, 1e-9, kFar)}, Vec3(0, -20, 0))};
  // What is left of the notch's elements holds one lip at its end: an asymmetry of that order.
  scene.fracture.alpha = 1e-12;
  scene.cracks = {notch({Vec3(-1, 9, -9), Vec3(5, 11, 9)}, Vec3(0, 10, 0), Vec3(5, 10, 0))};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  EXPECT_GE(tear(run, 1, 1), 10);
  for (const Vec2& p : run.cracks()[0].path) EXPECT_NEAR(p.y(), 10, 1e-8);
}

/// Two straight cracks that mirror each other, through the middle of cells, where the centroids of
/// some elements lie on the path itself: these take mirrored sides. In line with each other at
/// mid-height and off it, and side by side.
TEST(SplitSymmetry, CentroidsOnThePathTakeMirroredSides) {
  struct Pair {
    Vec2 left, right;
    double along, back;  // angles
  };
  const double up = EIGEN_PI / 2;
  for (const Pair& of :
       {Pair{{0, 6.5}, {20, 6.5}, 0, EIGEN_PI}, Pair{{0, 4.5}, {20, 4.5}, 0, EIGEN_PI},
        Pair{{4.5, 0}, {15.5, 0}, up, up}}) {
    const Problem problem(test::board_scene(
        test::with_image(test::structured_board({10, 13, 2, 10, 13, 2}), 0, 10), FractureModel::b));
    test::EdgeSplit board(problem);
    std::pair<Crack, fracture::SplitCrack> other;
    ASSERT_TRUE(board.begin_at(of.left, of.along).moved());
    std::swap(board.crack, other.first);
    std::swap(board.split, other.second);
    board.crack.id = 1;
    ASSERT_TRUE(board.begin_at(of.right, of.back).moved());
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(board.advance(0).moved());
      std::swap(board.crack, other.first);
      std::swap(board.split, other.second);
    }
    const Index half = problem.tet_count() / 2;
    constexpr std::array<int, 4> kImage{0, 1, 3, 2};
    int open = 0;
    for (Index e = 0; e < half; ++e) {
      for (int f = 0; f < 4; ++f) {
        const bool here = board.body.open({e, f});
        EXPECT_EQ(here, board.body.open({e + half, kImage[static_cast<std::size_t>(f)]})) << e;
        open += here;
      }
    }
    EXPECT_GT(open, 0);
  }
}

/// In line with each other, at mid-height and off it.
TEST(SplitSymmetry, CracksThatMirrorEachOtherStayImages) {
  for (const double height : {6.5, 4.5}) {
    Scene scene =
        torn(test::with_image(test::structured_board({15, 13, 1, 15, 13, 1}), 0, 15), 0.3);
    scene.supports.push_back({Box{Vec3(-kFar, 13 - 1e-9, -kFar), Vec3(kFar, kFar, kFar)}, Axes{3}});
    scene.instruments = {
        pull("down", {Vec3(-kFar, -kFar, -kFar), Vec3(kFar, 1e-9, kFar)}, Vec3(0, -30, 0))};
    scene.cracks = {notch({Vec3(-1, height - 0.5, -9), Vec3(4, height + 0.5, 9)},
                          Vec3(0, height, 0), Vec3(4, height, 0)),
                    notch({Vec3(26, height - 0.5, -9), Vec3(31, height + 0.5, 9)},
                          Vec3(30, height, 0), Vec3(26, height, 0))};
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
    EXPECT_GE(tear(run, 0, 2), 10) << height;
  }
}

TEST(SplitSymmetry, CracksSideBySideStayImages) {
  Scene scene = torn(test::with_image(test::structured_board({15, 20, 1, 15, 20, 1}), 0, 15), 0.3);
  scene.supports.push_back(
      {Box{Vec3(15 - 1e-9, -kFar, -kFar), Vec3(15 + 1e-9, kFar, kFar)}, Axes{1}});
  scene.supports.push_back(
      {Box{Vec3(15 - 1e-9, 20 - 1e-9, -kFar), Vec3(15 + 1e-9, kFar, kFar)}, Axes{2}});
  scene.instruments = {
      pull("left", {Vec3(-kFar, -kFar, -kFar), Vec3(1e-9, kFar, kFar)}, Vec3(-40, 0, 0)),
      pull("right", {Vec3(30 - 1e-9, -kFar, -kFar), Vec3(kFar, kFar, kFar)}, Vec3(40, 0, 0))};
  scene.cracks = {notch({Vec3(8, -1, -9), Vec3(9, 5, 9)}, Vec3(8.5, 0, 0), Vec3(8.5, 5, 0)),
                  notch({Vec3(21, -1, -9), Vec3(22, 5, 9)}, Vec3(21.5, 0, 0), Vec3(21.5, 5, 0))};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  EXPECT_GE(tear(run, 0, 2), 10);
}

}  // namespace
}  // namespace sunder
