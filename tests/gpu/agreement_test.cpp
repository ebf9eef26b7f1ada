// SPDX-License-Identifier: Apache-2.0
// The Vulkan backend against the CPU reference: intact, after scattered removals, along a crack,
// after a cut, with grips, at odd sizes.
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "agreement.hpp"
#include "body/supports.hpp"

namespace sunder::test {
namespace {

/// Tests that are passed by route cg as well.
class AgreementOfRoutes : public Agreement {};

TEST_P(AgreementOfRoutes, AlongACrack) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair, kIntactTolerance, "intact");
  follow(pair, crack_sequence(pair.problem(), 200, 10), kCrackTolerance);
}

TEST_P(AgreementOfRoutes, Scattered) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  follow(pair, scattered_sequence(pair.problem(), 200), kIntactTolerance);
}

TEST_P(AgreementOfRoutes, AfterACutInOneEvent) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  const auto cut = elements_across(pair.problem().mesh(), 26.5);
  pair.destroy(cut);
  // What is cut off has no displacement of its own; the attached part must stay right.
  std::vector<std::uint8_t> loose(pair.vulkan->destroyed().begin(), pair.vulkan->destroyed().end());
  const auto bodies = fem::find_bodies(pair.problem().mesh(), loose);
  for (std::size_t e = 0; e < loose.size(); ++e) {
    if (!loose[e] && centroid(pair.problem().mesh(), static_cast<Index>(e)).y() < 26.5)
      loose[e] = 1;
  }
  EXPECT_GE(bodies.count, 2);
  expect(pair, kCutTolerance, "attached part", loose);
}

TEST_P(AgreementOfRoutes, AfterACutElementByElement) {
  Pair pair(held_board(), GetParam());
  pair.load(load_of(pair.problem(), force_above_the_cut(pair.problem().mesh()), {}));
  for (Index e : elements_across(pair.problem().mesh(), 26.5)) pair.destroy({&e, 1});
  ASSERT_EQ(find_loose_parts(pair.problem(), pair.reference->destroyed()).pieces.size(), 1u);
  expect(pair, kCutTolerance, "attached part", loose_elements(*pair.reference));
  for (double u : Pair::displacement(*pair.vulkan)) ASSERT_TRUE(std::isfinite(u));
}

TEST_P(Agreement, ManyElementsInOneEvent) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  pair.destroy(crack_sequence(pair.problem(), 100, 10));
  expect(pair, kCrackTolerance, "100 at once");
}

TEST_P(Agreement, EveryNodeLoaded) {
  Pair pair(held_board(), GetParam());
  std::vector<Index> nodes;
  for (Index n = 0; n < pair.problem().node_count(); ++n) nodes.push_back(n);
  pair.load(pull(pair.problem(), nodes, Vec3(3, -40, 1)));
  expect(pair, kIntactTolerance, "intact");
  pair.destroy(crack_sequence(pair.problem(), 10, 10));
  expect(pair, kCrackTolerance, "10 fractures");
}

/// The board gripped at its lower edge, with and without supports at the top.
Scene gripped_board(bool supported) {
  Scene scene = held_board();
  Instrument low, high;
  low.name = "low";
  low.action = Grip{Box{Vec3(-1, -0.001, -1), Vec3(51, 0.001, 3)}, Vec3(1, -2, 0.5), Axes{7}};
  scene.instruments.push_back(low);
  if (!supported) {
    scene.supports.clear();
    high.name = "high";
    high.action = Grip{top_edge(), Vec3(0, 0, 0), Axes{7}};
    scene.instruments.push_back(high);
  }
  return scene;
}

TEST_P(Agreement, Grips) {
  for (const bool supported : {true, false}) {
    Pair pair(gripped_board(supported), GetParam());
    Load load =
        pull(pair.problem(), nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)}),
             Vec3(10, 0, 0));
    for (std::size_t i = 0; i < load.displacements.size(); ++i) {
      load.displacements[i] = 0.1 * static_cast<double>(i % 7) - 0.2;
    }
    pair.load(load);
    expect(pair, kIntactTolerance, "intact");
    pair.destroy(crack_sequence(pair.problem(), 20, 10));
    expect(pair, kCrackTolerance, "20 fractures");
    pair.expect_reactions(allowed(kCrackTolerance));
  }
}

TEST_P(Agreement, PristineFieldIgnoresDamage) {
  Pair pair(gripped_board(true), GetParam());
  const Load load = corner_pull(pair.problem(), Vec3(0, 0, 0));
  Load pulled =
      pull(pair.problem(), nodes_in(pair.problem().mesh(), {Vec3(49.9, 20, -1), Vec3(51, 30, 3)}),
           Vec3(10, 0, 0));
  for (std::size_t i = 0; i < pulled.displacements.size(); ++i) pulled.displacements[i] = 0.3;
  pair.load(pulled);
  pair.destroy(crack_sequence(pair.problem(), 5, 10));
  std::vector<double> u(3 * pair.problem().mesh().nodes.size()), reference(u.size());
  pair.vulkan->solve_pristine(pulled, u);
  pair.reference->solve_pristine(pulled, reference);
  const std::vector<std::uint8_t> none(pair.problem().mesh().tets.size(), 0);
  EXPECT_LE(displacement_error(pair.problem().mesh(), none, u, reference), kIntactTolerance);
}

/// Sizes that are no multiple of 64, down to a single element, with random corners.
Scene odd_scene(Index nx, Index ny, Index nz, const std::vector<Index>& keep) {
  Scene scene;
  scene.mesh = structured_board({nx, ny, nz, 1.0 * nx, 1.1 * ny, 0.9 * nz});
  std::mt19937 generator(static_cast<unsigned>(7 * nx + ny));
  std::uniform_real_distribution<double> shift(-0.1, 0.1);
  for (Vec3& x : scene.mesh.nodes) x += Vec3(shift(generator), shift(generator), shift(generator));
  if (!keep.empty()) {
    const auto all = scene.mesh.tets;
    scene.mesh.tets.clear();
    for (Index e : keep) scene.mesh.tets.push_back(all[e]);
    scene.mesh.volume_of.resize(keep.size());
    drop_unused_nodes(scene.mesh);
  }
  scene.materials["board"] = {5, 0.4, 2.0};
  return scene;
}

/// What is left of a random board when a third of its elements is taken away: of the pieces that
/// hang together by faces, the largest.
std::vector<Index> ragged(const Mesh& mesh, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<std::uint8_t> gone(mesh.tets.size(), 0);
  for (auto& g : gone) g = generator() % 3 == 0;
  std::map<std::array<Index, 3>, std::vector<Index>> faces;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (gone[e]) continue;
    for (int skip = 0; skip < 4; ++skip) {
      std::array<Index, 3> face{};
      for (int a = 0, f = 0; a < 4; ++a) {
        if (a != skip) face[f++] = mesh.tets[e][a];
      }
      std::sort(face.begin(), face.end());
      faces[face].push_back(e);
    }
  }
  std::vector<Index> piece(mesh.tets.size());
  std::iota(piece.begin(), piece.end(), 0);
  const std::function<Index(Index)> root = [&](Index e) {
    return piece[e] == e ? e : piece[e] = root(piece[e]);
  };
  for (const auto& [face, of] : faces) {
    if (of.size() == 2) piece[root(of[1])] = root(of[0]);
  }
  std::map<Index, std::vector<Index>> pieces;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (!gone[e]) pieces[root(e)].push_back(e);
  }
  return std::max_element(
             pieces.begin(), pieces.end(),
             [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); })
      ->second;
}

/// Elements in random order whose loss leaves the rest of the body in one piece, held.
std::vector<Index> harmless(const Problem& problem, std::size_t count) {
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  std::vector<Index> chosen;
  for (Index e : scattered_sequence(problem, destroyed.size())) {
    if (chosen.size() == count) break;
    destroyed[static_cast<std::size_t>(e)] = 1;
    if (find_loose_parts(problem, destroyed).pieces.empty()) {
      chosen.push_back(e);
    } else {
      destroyed[static_cast<std::size_t>(e)] = 0;
    }
  }
  return chosen;
}

TEST_P(AgreementOfRoutes, RaggedMeshesOfOddSizes) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto cells = static_cast<Index>(3 + seed);
    Scene whole = odd_scene(cells, 4, 2, {});
    Scene scene = odd_scene(cells, 4, 2, ragged(whole.mesh, seed));
    EXPECT_NE(scene.mesh.tets.size() % 64, 0u);
    const auto& held = scene.mesh.tets[scene.mesh.tets.size() / 2];
    scene.supports.push_back({std::vector<Index>{held.begin(), held.end()}, Axes{7}});
    Pair pair(std::move(scene), GetParam());
    EXPECT_NE(pair.problem().dof_count() % 64, 0);
    std::vector<Index> nodes;
    for (Index n = 0; n < pair.problem().node_count(); n += 3) nodes.push_back(n);
    pair.load(pull(pair.problem(), nodes, Vec3(0.01, -0.02, 0.03)));
    expect(pair, kIntactTolerance, "intact");
    const auto sequence = harmless(pair.problem(), 10);
    ASSERT_EQ(sequence.size(), 10u);
    follow(pair, sequence, kCrackTolerance);
  }
}

TEST_P(AgreementOfRoutes, OddSizes) {
  struct Size {
    Index nx, ny, nz;
    std::vector<Index> keep;  // elements, empty: all; 0 and 3 share a face
  };
  for (const Size& s :
       {Size{1, 1, 1, {0}}, Size{1, 1, 1, {0, 3}}, Size{3, 2, 1, {}}, Size{7, 5, 3, {}}}) {
    Scene scene = odd_scene(s.nx, s.ny, s.nz, s.keep);
    const auto nodes = static_cast<Index>(scene.mesh.nodes.size());
    // Three nodes that are held keep any body still.
    const auto& first = scene.mesh.tets.front();
    scene.supports.push_back({std::vector<Index>{first[0], first[1], first[2]}, Axes{7}});
    Pair pair(std::move(scene), GetParam());
    Index loaded = nodes - 1;
    while (pair.problem().dof(loaded, 0) == kNone) --loaded;
    pair.load(pull(pair.problem(), {loaded}, Vec3(0.1, -0.2, 0.3)));
    const std::string where = std::to_string(pair.problem().tet_count()) + " elements";
    expect(pair, kIntactTolerance, where);
    if (pair.problem().tet_count() < 2) continue;
    const Index last = pair.problem().tet_count() - 1;
    pair.destroy({&last, 1});
    expect(pair, kCutTolerance, where + ", one destroyed");
  }
}

TEST_P(Agreement, InverseInSeveralPanels) {
  Way way = GetParam();
  way.panel_bytes = std::size_t{6} << 20;  // the board's inverse takes 20 or 40 MB
  Pair pair(held_board(), way);
  std::vector<Index> nodes;
  for (Index n = 0; n < pair.problem().node_count(); n += 3) nodes.push_back(n);
  pair.load(pull(pair.problem(), nodes, Vec3(0, -60, 0)));
  expect(pair, kIntactTolerance, "intact");
  pair.destroy(crack_sequence(pair.problem(), 10, 10));
  expect(pair, kCrackTolerance, "10 fractures");
}

TEST_P(Agreement, ExcludedElementsAreNoCandidates) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  auto errors = pair.solve();
  std::set<Index> seen;
  for (int round = 0; round < 5; ++round) {
    const Index worst = errors.summary.candidate.element;
    EXPECT_EQ(worst, errors.reference_summary.candidate.element);
    EXPECT_TRUE(seen.insert(worst).second);
    pair.vulkan->exclude_candidates({&worst, 1});
    pair.reference->exclude_candidates({&worst, 1});
    errors = pair.solve();
    EXPECT_EQ(errors.summary.any.element, errors.reference_summary.any.element);
  }
}

TEST_P(Agreement, NothingLoaded) {
  Pair pair(held_board(), GetParam());
  pair.load({{}, {}, {}});
  const SolveReport report = pair.vulkan->solve();
  EXPECT_EQ(report.residual, 0);
  EXPECT_EQ(report.error, 0);
  for (double u : Pair::displacement(*pair.vulkan)) EXPECT_EQ(u, 0);
  EXPECT_EQ(pair.vulkan->stress().any.element, kNone);
}

INSTANTIATE_TEST_SUITE_P(All, Agreement, testing::ValuesIn(all_ways()),
                         [](const auto& tested) { return name_of(tested.param); });
INSTANTIATE_TEST_SUITE_P(All, AgreementOfRoutes, testing::ValuesIn(ways_of_every_route()),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
