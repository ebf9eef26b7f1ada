// SPDX-License-Identifier: Apache-2.0
// The Vulkan backend against the CPU reference: intact, after scattered removals, along a crack,
// after a cut, at extreme contrast and compressibility, with grips, at odd sizes.
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

#include "fem/supports.hpp"
#include "gpu_body.hpp"
#include "pieces.hpp"

namespace sunder::test {
namespace {

// Fp32 storage by the mixed recipe, any damage (design of the accuracy table).
constexpr double kFp32Tolerance = 1e-4;
// Eager fp32, intact and up to ten scattered fractures.
constexpr double kEagerFp32Tolerance = 1e-3;

class Agreement : public WithVulkan<testing::TestWithParam<Way>> {
 protected:
  [[nodiscard]] bool fp64() const { return GetParam().precision == Precision::fp64; }
  [[nodiscard]] bool eager() const { return GetParam().update == Update::eager; }
  /// Eager fp32 keeps 1e-3 over a few scattered fractures, and leaves for the mixed recipe before
  /// its own tolerance is passed.
  [[nodiscard]] double allowed(double of_fp64, bool short_scene = false) const {
    if (fp64()) return of_fp64;
    if (!eager()) return kFp32Tolerance;
    return short_scene ? kEagerFp32Tolerance : GetParam().tolerance;
  }
  static void expect(const Pair::Errors& e, double allowed, const std::string& where) {
    EXPECT_TRUE(e.u <= allowed) << where << ": displacement error " << e.u;
    EXPECT_TRUE(e.stress <= allowed) << where << ": stress error " << e.stress;
  }
  static void expect_same_summary(const Pair::Errors& e, double allowed) {
    EXPECT_EQ(e.summary.any.element, e.reference_summary.any.element);
    EXPECT_NEAR(e.summary.any.ratio, e.reference_summary.any.ratio,
                10 * allowed * e.reference_summary.any.ratio);
    EXPECT_EQ(e.summary.candidate.element, e.reference_summary.candidate.element);
  }

  /// Destroys a sequence one by one, and compares at the accuracy table's counts up to `last`.
  void follow(Pair& pair, const std::vector<Index>& sequence, std::size_t last, double tolerance,
              bool scattered = false) {
    std::size_t done = 0;
    for (std::size_t count : {1, 10, 50, 100, 200}) {
      if (count > last) break;
      ASSERT_LE(count, sequence.size());
      for (; done < count; ++done) pair.destroy({&sequence[done], 1});
      const auto errors = pair.solve();
      const double most = allowed(tolerance, scattered && count <= 10);
      expect(errors, most, std::to_string(count) + " fractures");
      expect_same_summary(errors, most);
      record(count, errors);
    }
  }
  /// The drift curve, in the test's report.
  static void record(std::size_t count, const Pair::Errors& errors) {
    const auto text = [](double value) { return (std::ostringstream() << value).str(); };
    RecordProperty("u_after_" + std::to_string(count), text(errors.u));
    RecordProperty("stress_after_" + std::to_string(count), text(errors.stress));
  }
};

TEST_P(Agreement, AlongACrack) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kIntactTolerance, true), "intact");
  follow(pair, crack_sequence(pair.problem(), 200, 10), 200, kCrackTolerance);
}

TEST_P(Agreement, Scattered) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  // 200 eager updates in the variant that is slow on lavapipe: along a crack alone.
  const std::size_t last = eager() && GetParam().variant == gpu::Variant::gpu ? 50 : 200;
  follow(pair, scattered_sequence(pair.problem(), last), last, kIntactTolerance, true);
}

TEST_P(Agreement, AfterACutInOneEvent) {
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
  const auto errors = pair.solve(loose);
  expect(errors, allowed(kCutTolerance), "attached part");
  if (!fp64()) {
    EXPECT_EQ(pair.vulkan->info().update, "deferred");
  }
}

// The force on the attached part keeps its field one worth checking; a little hangs below.
TEST_P(Agreement, AfterACutElementByElement) {
  Pair pair(held_board(), GetParam());
  const Mesh& mesh = pair.problem().mesh();
  std::vector<double> force =
      shared_force(mesh, nodes_in(mesh, {Vec3(49.9, 35, -1), Vec3(51, 45, 3)}), Vec3(5, 0, 0));
  const auto below = corner_force(mesh, Vec3(0, -6e-3, 0));
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += below[i];
  pair.load(load_of(pair.problem(), force, {}));
  for (Index e : elements_across(mesh, 26.5)) pair.destroy({&e, 1});
  const auto pieces = find_loose_parts(pair.problem(), pair.reference->destroyed()).pieces;
  ASSERT_EQ(pieces.size(), 1u);
  std::vector<std::uint8_t> loose(mesh.tets.size(), 0);
  for (Index e : pieces.front()) loose[static_cast<std::size_t>(e)] = 1;
  expect(pair.solve(loose), allowed(kCutTolerance), "attached part");
  for (double u : Pair::displacement(*pair.vulkan)) ASSERT_TRUE(std::isfinite(u));
}

TEST_P(Agreement, ManyElementsInOneEvent) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  pair.destroy(crack_sequence(pair.problem(), 100, 10));
  expect(pair.solve(), allowed(kCrackTolerance), "100 at once");
}

TEST_P(Agreement, ContrastOf10000) {
  Scene scene = held_board();
  set_contrast(scene, 1e4);
  Pair pair(std::move(scene), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kCrackTolerance), "intact");
  follow(pair, crack_sequence(pair.problem(), 50, 10), 50, kCrackTolerance);
}

TEST_P(Agreement, NearlyIncompressible) {
  Scene scene = held_board();
  set_poisson(scene, 0.499);
  Pair pair(std::move(scene), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kCrackTolerance), "intact");
  follow(pair, crack_sequence(pair.problem(), 50, 10), 50, kCrackTolerance);
}

TEST_P(Agreement, EveryNodeLoaded) {
  Pair pair(held_board(), GetParam());
  std::vector<Index> nodes;
  for (Index n = 0; n < pair.problem().node_count(); ++n) nodes.push_back(n);
  pair.load(pull(pair.problem(), nodes, Vec3(3, -40, 1)));
  expect(pair.solve(), allowed(kIntactTolerance), "intact");
  pair.destroy(crack_sequence(pair.problem(), 10, 10));
  expect(pair.solve(), allowed(kCrackTolerance), "10 fractures");
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
    expect(pair.solve(), allowed(kIntactTolerance), "intact");
    pair.destroy(crack_sequence(pair.problem(), 20, 10));
    expect(pair.solve(), allowed(kCrackTolerance), "20 fractures");
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

TEST_P(Agreement, RaggedMeshesOfOddSizes) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto cells = static_cast<Index>(3 + seed);
    Scene whole = odd_scene(cells, 4, 2, {});
    Scene scene = odd_scene(cells, 4, 2, ragged(whole.mesh, seed));
    EXPECT_NE(scene.mesh.tets.size() % 64, 0u);
    const auto& held = scene.mesh.tets[scene.mesh.tets.size() / 2];
    scene.supports.push_back({std::vector<Index>{held.begin(), held.end()}, Axes{7}});
    Pair pair(std::move(scene), GetParam());
    std::vector<Index> nodes;
    for (Index n = 0; n < pair.problem().node_count(); n += 3) nodes.push_back(n);
    pair.load(pull(pair.problem(), nodes, Vec3(0.01, -0.02, 0.03)));
    expect(pair.solve(), allowed(kIntactTolerance, true), "seed " + std::to_string(seed));
  }
}

TEST_P(Agreement, OddSizes) {
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
    expect(pair.solve(), allowed(kIntactTolerance), where);
    if (pair.problem().tet_count() < 2) continue;
    const Index last = pair.problem().tet_count() - 1;
    pair.destroy({&last, 1});
    expect(pair.solve(), allowed(kCutTolerance), where + ", one destroyed");
  }
}

TEST_P(Agreement, InverseInSeveralPanels) {
  Way way = GetParam();
  way.panel_bytes = std::size_t{6} << 20;  // the board's inverse takes 20 or 40 MB
  Pair pair(held_board(), way);
  std::vector<Index> nodes;
  for (Index n = 0; n < pair.problem().node_count(); n += 3) nodes.push_back(n);
  pair.load(pull(pair.problem(), nodes, Vec3(0, -60, 0)));
  expect(pair.solve(), allowed(kIntactTolerance), "intact");
  pair.destroy(crack_sequence(pair.problem(), 10, 10));
  expect(pair.solve(), allowed(kCrackTolerance), "10 fractures");
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

}  // namespace
}  // namespace sunder::test
