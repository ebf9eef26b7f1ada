// SPDX-License-Identifier: Apache-2.0
// The Vulkan backend against the CPU reference: intact, after scattered removals, along a crack,
// after a cut, at extreme contrast and compressibility, with grips, at odd sizes.
#include <set>

#include "fem/supports.hpp"
#include "gpu_body.hpp"

namespace sunder::test {
namespace {

// Fp32 storage by the mixed recipe, any damage (design of the accuracy table).
constexpr double kFp32Tolerance = 1e-4;

class Agreement : public WithVulkan<testing::TestWithParam<Way>> {
 protected:
  [[nodiscard]] bool fp64() const { return GetParam().precision == Precision::fp64; }
  [[nodiscard]] bool eager() const { return GetParam().update == Update::eager; }
  /// Eager fp32 promises its own tolerance only.
  [[nodiscard]] double allowed(double of_fp64) const {
    return fp64() ? of_fp64 : std::max(kFp32Tolerance, eager() ? GetParam().tolerance : 0.0);
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

  /// Destroys a sequence one by one, and compares at some counts.
  void follow(Pair& pair, const std::vector<Index>& sequence, std::vector<std::size_t> counts,
              double tolerance) {
    std::size_t done = 0;
    for (std::size_t count : counts) {
      ASSERT_LE(count, sequence.size());
      for (; done < count; ++done) pair.destroy({&sequence[done], 1});
      const auto errors = pair.solve();
      expect(errors, allowed(tolerance), std::to_string(count) + " fractures");
      expect_same_summary(errors, allowed(tolerance));
    }
  }
};

TEST_P(Agreement, AlongACrack) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kIntactTolerance), "intact");
  // The eager update rewrites the whole inverse each time: fewer of them on a processor.
  follow(
      pair, crack_sequence(pair.problem(), 200, 10),
      eager() ? std::vector<std::size_t>{1, 10, 50} : std::vector<std::size_t>{1, 10, 50, 100, 200},
      kCrackTolerance);
}

TEST_P(Agreement, Scattered) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  follow(
      pair, scattered_sequence(pair.problem(), 200),
      eager() ? std::vector<std::size_t>{1, 10, 20} : std::vector<std::size_t>{1, 10, 50, 100, 200},
      kIntactTolerance);
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

TEST_P(Agreement, ManyElementsInOneEvent) {
  Pair pair(held_board(), GetParam());
  pair.load(corner_pull(pair.problem()));
  pair.destroy(crack_sequence(pair.problem(), 100, 10));
  expect(pair.solve(), allowed(kCrackTolerance), "100 at once");
}

TEST_P(Agreement, ContrastOf10000) {
  Scene scene = held_board();
  for (auto& [name, material] : scene.materials) {
    if (!material.yield) material.young = 5e4;
  }
  Pair pair(std::move(scene), GetParam());
  pair.load(corner_pull(pair.problem()));
  const auto crack = crack_sequence(pair.problem(), 20, 10);
  expect(pair.solve(), allowed(kCrackTolerance), "intact");
  pair.destroy(crack);
  expect(pair.solve(), allowed(kCrackTolerance), "20 fractures");
}

TEST_P(Agreement, NearlyIncompressible) {
  Scene scene = held_board();
  for (auto& [name, material] : scene.materials) material.poisson = 0.499;
  Pair pair(std::move(scene), GetParam());
  pair.load(corner_pull(pair.problem()));
  const auto crack = crack_sequence(pair.problem(), 20, 10);
  expect(pair.solve(), allowed(kCrackTolerance), "intact");
  pair.destroy(crack);
  expect(pair.solve(), allowed(kCrackTolerance), "20 fractures");
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
    std::vector<double> r(load.displacements.size()), reference(r.size());
    pair.vulkan->read_reactions(r);
    pair.reference->read_reactions(reference);
    double largest = 0;
    for (double v : reference) largest = std::max(largest, std::abs(v));
    for (std::size_t i = 0; i < r.size(); ++i) {
      EXPECT_NEAR(r[i], reference[i], allowed(kCrackTolerance) * largest) << "grip " << i;
    }
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
