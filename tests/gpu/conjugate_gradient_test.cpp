// SPDX-License-Identifier: Apache-2.0
// Route cg on the device against the CPU reference.
#include <random>

#include "cpu_reference/plain/plain.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

class ConjugateGradient : public WithVulkan<testing::TestWithParam<gpu::Variant>> {
 protected:
  [[nodiscard]] static Way way() {
    return {.variant = GetParam(), .update = Update::automatic, .route = Route::cg};
  }
  static void expect(const Pair::Errors& e, double allowed, const std::string& where) {
    EXPECT_TRUE(e.u <= allowed) << where << ": displacement error " << e.u;
    EXPECT_TRUE(e.stress <= allowed) << where << ": stress error " << e.stress;
    EXPECT_EQ(e.summary.any.element, e.reference_summary.any.element) << where;
  }
};

TEST_P(ConjugateGradient, IntactAndAlongACrack) {
  Pair pair(held_board(), way());
  pair.load(corner_pull(pair.problem()));
  const auto intact = pair.solve();
  expect(intact, kIntactTolerance, "intact");
  EXPECT_GT(intact.report.iterations, 0);
  const auto crack = crack_sequence(pair.problem(), 200, 10);
  std::size_t done = 0;
  for (const std::size_t count : {1, 10, 50, 100, 200}) {
    pair.destroy({&crack[done], count - done});
    done = count;
    expect(pair.solve(), kCrackTolerance, std::to_string(count) + " fractures");
  }
}

TEST_P(ConjugateGradient, Scattered) {
  Pair pair(held_board(), way());
  pair.load(corner_pull(pair.problem()));
  const auto sequence = scattered_sequence(pair.problem(), 100);
  pair.destroy(sequence);
  expect(pair.solve(), kIntactTolerance, "100 fractures");
}

TEST_P(ConjugateGradient, GripsWithReactions) {
  Scene scene = held_board();
  Instrument low;
  low.name = "low";
  low.action = Grip{Box{Vec3(-1, -0.001, -1), Vec3(51, 0.001, 3)}, Vec3(1, -2, 0.5), Axes{3}};
  scene.instruments.push_back(low);
  Pair pair(std::move(scene), way());
  Load load =
      pull(pair.problem(), nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)}),
           Vec3(10, 0, 0));
  for (std::size_t i = 0; i < load.displacements.size(); ++i) {
    load.displacements[i] = 0.1 * static_cast<double>(i % 7) - 0.2;
  }
  pair.load(load);
  expect(pair.solve(), kIntactTolerance, "grips");
  pair.expect_reactions(kCrackTolerance);
}

/// The last solution is the first guess: it must help where it can and do no harm where it cannot.
TEST_P(ConjugateGradient, LoadsThatGrowTurnVanishAndComeBack) {
  Pair pair(held_board(), way());
  const Load corner = corner_pull(pair.problem());
  Load grown = corner;
  for (double& f : grown.forces) f *= 1.7;
  const auto edge = nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)});
  pair.load(corner);
  expect(pair.solve(), kIntactTolerance, "corner");
  pair.load(grown);
  const auto multiple = pair.solve();
  expect(multiple, kIntactTolerance, "grown");
  EXPECT_EQ(multiple.report.iterations, 0);
  pair.load(pull(pair.problem(), edge, Vec3(1e-6, 0, 0)));
  expect(pair.solve(), kIntactTolerance, "a millionth of it, elsewhere");
  pair.load(corner);
  expect(pair.solve(), kIntactTolerance, "corner again");
  pair.load({{}, {}, {}});
  EXPECT_EQ(pair.vulkan->solve().error, 0);
  for (double u : Pair::displacement(*pair.vulkan)) EXPECT_EQ(u, 0);
  pair.load(corner);
  expect(pair.solve(), kIntactTolerance, "after none");
}

/// After the first full check a frame's residual speaks for it, until sixteen events have passed.
/// The truth is that of the body factored anew, in extended precision.
TEST_P(ConjugateGradient, ErrorsAreNeverUnderTheTruth) {
  Pair pair(held_board(), way());
  Load load = corner_pull(pair.problem());
  const auto crack = crack_sequence(pair.problem(), 48, 10);
  const auto solve = [&](const std::string& where, bool against_the_truth) {
    pair.load(load);
    const double said = pair.vulkan->solve().error;
    EXPECT_LE(said, kCrackTolerance) << where;
    if (!against_the_truth) return;
    static_cast<void>(pair.vulkan->stress());
    plain::Body body(pair.problem(), pair.vulkan->destroyed());
    std::vector<Voigt> stress(pair.problem().mesh().tets.size());
    pair.vulkan->read_stress(stress);
    const double truth = stress_error(pair.vulkan->destroyed(), stress, body.solve(load).stress);
    EXPECT_GE(said, truth) << where;
  };
  solve("intact", true);
  for (std::size_t i = 0; i < crack.size(); ++i) {
    const std::string where = std::to_string(i);
    const bool against_the_truth = i % 16 == 14;  // long after a check
    pair.destroy({&crack[i], 1});
    solve(where, against_the_truth);
    if (!against_the_truth) continue;
    load.forces[0] *= 1.2;  // without an event
    solve(where + ", turned", true);
    load.forces[0] *= 1.05;  // a sum of both
    solve(where + ", turned again", true);
  }
}

/// Of a scene without instruments, whose host turns the load: what was solved first stays known.
TEST_P(ConjugateGradient, AMultipleOfATurnedLoadTakesNoIteration) {
  Pair pair(held_board(), way());
  ASSERT_TRUE(pair.problem().scene().instruments.empty());
  Load load = corner_pull(pair.problem());
  const auto crack = crack_sequence(pair.problem(), 1, 10);
  pair.destroy(crack);
  pair.load(load);
  EXPECT_GT(pair.solve().report.iterations, 0);
  load.forces[0] *= 1.01;
  pair.load(load);
  const auto turned = pair.solve();
  expect(turned, kCrackTolerance, "turned");
  EXPECT_GT(turned.report.iterations, 0);
  for (double& f : load.forces) f *= 1.2;
  pair.load(load);
  const auto multiple = pair.solve();
  expect(multiple, kCrackTolerance, "and grown");
  EXPECT_EQ(multiple.report.iterations, 0);
}

/// A sum of former loads takes a step along each of their solutions and no iteration (CgKernels);
/// what is left here are those of the error's estimate.
TEST_P(ConjugateGradient, HandsThatWanderStayRight) {
  Scene scene = held_board();
  Instrument low;
  low.action = Grip{Box{Vec3(-1, -0.001, -1), Vec3(51, 0.001, 3)}, Vec3(1, -2, 0.5), Axes{1}};
  scene.instruments.assign(2, low);
  scene.instruments[1].action = Pull{Box{Vec3(49.9, 20, -1), Vec3(51, 30, 3)}, Vec3(1, 0, 0)};
  Pair pair(std::move(scene), way());
  const auto edge = nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)});
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto crack = crack_sequence(pair.problem(), 20, 10);
  std::size_t destroyed = 0;
  for (const std::size_t count : {0, 1, 20}) {
    pair.destroy({&crack[destroyed], count - destroyed});
    destroyed = count;
    int of_a_new_body = 0;
    for (int i = 0; i < 10; ++i) {
      Load load =
          pull(pair.problem(), edge, 10 * Vec3(any(generator), any(generator), any(generator)));
      std::ranges::fill(load.displacements, 0.1 * any(generator));
      pair.load(load);
      const auto found = pair.solve();
      expect(found, count == 0 ? kIntactTolerance : kCrackTolerance, std::to_string(i));
      if (i == 0) of_a_new_body = found.report.iterations;
      if (i >= 4) {
        EXPECT_LE(found.report.iterations, of_a_new_body / 2) << i;
      }
    }
  }
}

/// More loads than there is room for.
TEST_P(ConjugateGradient, ManyDirectionsStayRight) {
  Pair pair(held_board(), way());
  const auto edge = nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)});
  for (std::size_t i = 0; i < 16; ++i) {
    pair.load(
        pull(pair.problem(), {edge[i % edge.size()]}, Vec3(1, static_cast<double>(i % 3), -1)));
    expect(pair.solve(), kIntactTolerance, std::to_string(i));
  }
}

TEST_P(ConjugateGradient, NothingLoadedTakesNoIteration) {
  Pair pair(held_board(), way());
  pair.load({{}, {}, {}});
  EXPECT_EQ(pair.vulkan->solve().iterations, 0);
  for (double u : Pair::displacement(*pair.vulkan)) EXPECT_EQ(u, 0);
}

/// A body with frames a hundred times as stiff, held at the top, pulled at its lower right edge.
Scene framed_body(const BoardShape& shape) {
  Scene scene;
  const auto of_height = [&](const Vec3& x) { return x.y() / shape.height; };
  scene.mesh = structured_board(shape, [&](const Vec3& x) {
    return of_height(x) > 0.9 || of_height(x) < 0.1 ? "frame" : "tissue";
  });
  scene.materials = {{"tissue", {5, 0.4, 2.0}}, {"frame", {500, 0.4, std::nullopt}}};
  scene.supports.push_back(
      {Box{Vec3(-1, 0.9999 * shape.height, -1), Vec3(1e3, 1e3, 1e3)}, Axes{7}});
  return scene;
}

/// Elements of the cells whose centres lie in a box.
std::vector<Index> cells_in(const Problem& problem, const BoardShape& shape, const Box& box) {
  std::vector<Index> found;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Index c = e / 6;
    const Vec3 cell(c % shape.nx, c / shape.nx % shape.ny, c / shape.nx / shape.ny);
    const Vec3 centre = (cell + Vec3::Constant(0.5))
                            .cwiseProduct(Vec3(shape.width / shape.nx, shape.height / shape.ny,
                                               shape.depth / shape.nz));
    if ((centre - box.min).minCoeff() > 0 && (box.max - centre).minCoeff() > 0) found.push_back(e);
  }
  return found;
}

using RecordedIterations = WithVulkan<>;

// As many groups and aggregates as before, but more entries between them: their buffers are new,
// and iterations that were recorded with the old ones must not be submitted again.
TEST_F(RecordedIterations, FollowLevelsThatAreMadeAnew) {
  const BoardShape shape{36, 36, 1, 50, 50, 2.5};
  const double side = 50.0 / 36;
  Pair pair(framed_body(shape), {.update = Update::automatic, .route = Route::cg});
  pair.load(pull(pair.problem(),
                 nodes_in(pair.problem().mesh(), {Vec3(49.9, -1, -1), Vec3(51, 4, 51)}),
                 Vec3(0.1, -1, 0.3)));
  pair.solve();
  const auto cells = [&](int x, int y, int end_x, int end_y) {
    return cells_in(pair.problem(), shape,
                    {Vec3(x * side, y * side, -1), Vec3(end_x * side, end_y * side, 51)});
  };
  auto cut = cells(10, 10, 12, 12);
  for (Index e : cells(12, 10, 16, 11)) cut.push_back(e);
  std::ranges::sort(cut);
  EXPECT_EQ(cut.size(), 48u);
  pair.destroy(cut);
  EXPECT_LE(pair.solve().u, kCutTolerance);
}

/// Hundreds of groups of nodes, and their aggregates, thick and thin: intact, with a cut through
/// nine tenths of the width, and once a piece has come off.
TEST_P(ConjugateGradient, LargeBodiesTakeUnderTwoHundredIterations) {
  std::vector<BoardShape> shapes{{36, 36, 1, 50, 50, 2.5}};
  if (GetParam() == gpu::Variant::lvp) {  // the other one takes twice as long
    shapes = {{71, 71, 1, 50, 50, 2.5}, {18, 18, 18, 50, 50, 50}};
  }
  for (const BoardShape& shape : shapes) {
    const std::string body = shape.nz > 1 ? "block, " : "board, ";
    Pair pair(framed_body(shape), way());
    pair.load(pull(pair.problem(),
                   nodes_in(pair.problem().mesh(), {Vec3(49.9, -1, -1), Vec3(51, 4, 51)}),
                   Vec3(0.1, -1, 0.3)));
    const auto intact = pair.solve();
    expect(intact, kIntactTolerance, body + "intact");
    EXPECT_LE(intact.report.iterations, 200) << body;
    const Index row = shape.ny / 2;
    const double side = 50.0 / shape.ny;
    const auto cut =
        cells_in(pair.problem(), shape, {Vec3(-1, row * side, -1), Vec3(45, (row + 1) * side, 51)});
    pair.destroy(cut);
    const auto after = pair.solve();
    expect(after, kCutTolerance, body + "cut");
    EXPECT_LE(after.report.iterations, 300) << body << "cut, corrected once";
    // A piece comes off inside, of which two layers of cells are destroyed.
    const double depth = shape.nz > 1 ? 2 * side : 0;
    std::vector<std::uint8_t> loose(pair.problem().mesh().tets.size(), 0);
    const auto part_off = [&](const Vec3& low, const Vec3& high) {
      const Vec3 in(2 * side, 2 * side, depth);
      const auto outer = cells_in(pair.problem(), shape, {low, high});
      const auto inner = cells_in(pair.problem(), shape, {low + in, high - in});
      std::vector<Index> shell;
      std::ranges::set_difference(outer, inner, std::back_inserter(shell));
      for (Index e : inner) loose[e] = 1;
      return std::pair(shell, inner);
    };
    const double back = shape.nz > 1 ? 10 : -1, front = shape.nz > 1 ? 25 : 51;
    const auto [first, piece] = part_off({10, 30, back}, {25, 40, front});
    pair.destroy(first);
    const auto apart = pair.solve(loose);
    expect(apart, kCutTolerance, body + "piece");
    EXPECT_LE(apart.report.iterations, 460) << body << "piece, corrected";
    // It is destroyed as another one comes off: as many pieces as before, but others.
    std::vector<Index> both = part_off({25, 8, back}, {42, 19, front}).first;
    both.insert(both.end(), piece.begin(), piece.end());
    std::ranges::sort(both);
    pair.destroy(both);
    const auto another = pair.solve(loose);
    expect(another, kCutTolerance, body + "another piece");
    EXPECT_LE(another.report.iterations, 600) << body << "another piece, corrected";
  }
}

TEST_P(ConjugateGradient, AnUpdateOfTheInverseIsRefused) {
  Scene scene = held_board();
  scene.solver = {.backend = "vulkan", .route = Route::cg, .update = Update::eager};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  EXPECT_THROW(static_cast<void>(gpu::create(problem, all_needs())), DeviceError);
}

INSTANTIATE_TEST_SUITE_P(All, ConjugateGradient,
                         testing::Values(gpu::Variant::gpu, gpu::Variant::lvp),
                         [](const auto& tested) {
                           return tested.param == gpu::Variant::gpu ? "gpu" : "lvp";
                         });

}  // namespace
}  // namespace sunder::test
