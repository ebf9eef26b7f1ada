// SPDX-License-Identifier: Apache-2.0
// Route `condensed`: a strip of a larger board can tear, and only its unknowns are kept. Everything
// that can be read is compared with the yardstick's solution of the whole body.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "body/pieces.hpp"
#include "support/accuracy.hpp"
#include "support/body.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

struct CondensedCase {
  const char* name;
  bool crack;
  std::size_t batch;
  double contrast = 1, poisson = 0.4, alpha = 1e-6;
  bool instrument = true, grip = false;
};

/// 50 x 50 x 2.5 mm, 1680 elements; three rows of cells around y = 26 can tear, 360 of 1800
/// unknowns.
Scene organ(const CondensedCase& c) {
  Scene scene;
  scene.mesh = structured_board({14, 20, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() > 22.5 && x.y() < 30 ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, c.poisson, 2.0}},
                     {"organ", {5 * c.contrast, c.poisson, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  scene.solver.backend = "cpu";
  scene.solver.route = Route::condensed;
  scene.fracture.alpha = c.alpha;
  if (c.instrument) {
    Instrument forceps;
    forceps.name = "forceps";
    forceps.action = Pull{lower_right_corner(), Vec3(0, -60, 0)};
    scene.instruments.push_back(forceps);
  }
  if (c.grip) {
    Instrument grip;
    grip.name = "grip";
    grip.action = Grip{Box{Vec3(-0.1, -0.1, -1), Vec3(0.1, 0.1, 4)}, Vec3(-0.5, 0.25, 0), Axes{3}};
    scene.instruments.push_back(grip);
  }
  return scene;
}

std::vector<double> moved(const Problem& problem) {
  std::vector<double> d;
  for (Index g : problem.gripped_dofs()) {
    for (Index n = 0; n < problem.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem.dof(n, axis) == g) d.push_back(axis == 0 ? -0.5 : 0.25);
      }
    }
  }
  return d;
}

void expect_agreement(const Body& body, std::span<const double> force,
                      std::span<const std::uint8_t> ignored, double tolerance) {
  const auto right =
      yardstick(*body.problem, body.backend->destroyed(), force, moved(*body.problem));
  EXPECT_LE(
      displacement_error(body.problem->mesh(), ignored, body.displacement(), right.displacement),
      tolerance);
  EXPECT_LE(stress_error(ignored, body.stress(), right.stress), tolerance);
}

class Condensed : public ::testing::TestWithParam<CondensedCase> {};

TEST_P(Condensed, StaysWithinTheTable) {
  const CondensedCase& c = GetParam();
  const Body body(organ(c));
  EXPECT_EQ(body.backend->info().route, "condensed");
  EXPECT_EQ(body.backend->info().update, "deferred");
  const std::vector<double> force = corner_force(body.problem->mesh());
  const auto sequence =
      c.crack ? crack_sequence(*body.problem, 180, 12) : scattered_sequence(*body.problem, 180);
  body.load(force, moved(*body.problem));
  std::size_t done = 0;
  for (std::size_t k : {std::size_t{0}, std::size_t{10}, std::size_t{60}, std::size_t{180}}) {
    while (done < k) {
      const std::size_t count = std::min(c.batch, k - done);
      body.backend->destroy(std::span(sequence).subspan(done, count));
      done += count;
    }
    SCOPED_TRACE(done);
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, 1e-4);
    EXPECT_FALSE(report.polished);
    EXPECT_EQ(report.iterations, 0);
    // 180 of the strip's 252 elements leave it in shreds: no scattered damage any more.
    const bool torn = c.crack || k > 60;
    expect_agreement(body, force, body.backend->destroyed(),
                     torn ? kCrackTolerance : kIntactTolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sequences, Condensed,
    ::testing::Values(CondensedCase{"Scattered", false, 1}, CondensedCase{"Crack", true, 1},
                      CondensedCase{"CrackBy60", true, 60},
                      CondensedCase{"Contrast1e4", true, 10, 1e4},
                      CondensedCase{"Poisson499", true, 10, 1, 0.499},
                      CondensedCase{"Alpha1e9", true, 10, 1, 0.4, 1e-9},
                      CondensedCase{"LoadedOutside", true, 10, 1, 0.4, 1e-6, false},
                      CondensedCase{"Grips", true, 10, 1, 0.4, 1e-6, true, true}),
    [](const auto& p) { return p.param.name; });

Scene torn_organ() { return organ({"", true, 1}); }

TEST(CondensedRoute, KeepsTheAttachedPartRightAfterACut) {
  const Body body(torn_organ());
  const auto force = corner_force(body.problem->mesh());
  // Pulled above the cut as well, or nothing would be left to compare.
  std::vector<double> both = force;
  for (Index n : nodes_in(body.problem->mesh(), {Vec3(49.9, 39, -1), Vec3(51, 41, 3)})) {
    both[3 * static_cast<std::size_t>(n)] = 2;
  }
  body.load(both);
  for (const Index& e : elements_across(body.problem->mesh(), 26.5)) {
    body.backend->destroy({&e, 1});
  }
  const SolveReport report = body.backend->solve();
  EXPECT_LE(report.error, 1e-4);
  std::vector<std::uint8_t> ignored(body.backend->destroyed().begin(),
                                    body.backend->destroyed().end());
  const LooseParts loose = find_loose_parts(*body.problem, body.backend->destroyed());
  ASSERT_FALSE(loose.pieces.empty());
  for (const auto& piece : loose.pieces) {
    for (Index e : piece) ignored[e] = 1;
  }
  for (double u : body.displacement()) ASSERT_TRUE(std::isfinite(u));
  expect_agreement(body, both, ignored, kCutTolerance);
}

TEST(CondensedRoute, FollowsAnElementThatNobodyExpectedToBreak) {
  const Body body(torn_organ());
  const auto force = corner_force(body.problem->mesh());
  body.load(force);
  const auto sequence = crack_sequence(*body.problem, 12, 12);
  body.backend->destroy(std::span(sequence).first(6));
  body.backend->solve();
  body.backend->stress();
  const auto organ_elements = elements_across(body.problem->mesh(), 10.1);
  const Index unexpected = organ_elements.front();
  ASSERT_FALSE(body.problem->breakable(unexpected));
  const Voigt before = body.backend->read_stress(unexpected);
  body.backend->destroy(std::span(organ_elements).first(5));
  EXPECT_EQ(body.backend->read_stress(unexpected), before) << "the last stress() holds";
  body.backend->destroy(std::span(sequence).subspan(6));
  body.backend->solve();
  expect_agreement(body, force, body.backend->destroyed(), kCrackTolerance);
}

bool on_an_updated_inverse(const Body& body) {
  return std::ranges::any_of(body.backend->buffers(), [](const BufferPlan& b) {
    return b.name == "stiffness lost between factor and inverse";
  });
}

/// Pulls the corner in some direction.
std::vector<double> pull(const Mesh& mesh, const Vec3& force) {
  std::vector<double> nodal(3 * mesh.nodes.size(), 0.0);
  for (Index n : nodes_in(mesh, lower_right_corner())) {
    for (int axis = 0; axis < 3; ++axis)
      nodal[3 * static_cast<std::size_t>(n) + axis] = force[axis];
  }
  return nodal;
}

// After a new base X_SS is no longer the factor's: what leaves S has to make up for that.
TEST(CondensedRoute, GrowsAndIsLoadedOutsideItsRegionOnANewBase) {
  const Body body(torn_organ());
  std::vector<double> force = corner_force(body.problem->mesh());
  const auto far = nodes_in(body.problem->mesh(), {Vec3(-0.1, 9.9, -1), Vec3(0.1, 10.1, 3)});
  ASSERT_FALSE(far.empty());
  for (Index n : far) force[3 * static_cast<std::size_t>(n)] = -4;
  body.load(force);
  for (const Index& e : crack_sequence(*body.problem, 150, 12)) body.backend->destroy({&e, 1});
  ASSERT_TRUE(on_an_updated_inverse(body));
  const auto outside = elements_across(body.problem->mesh(), 10.1);
  body.backend->destroy(std::span(outside).first(5));
  EXPECT_LE(body.backend->solve().error, kCrackTolerance);
  expect_agreement(body, force, body.backend->destroyed(), kCrackTolerance);
}

/// A board of one layer of cells that can tear in a patch of so many at the middle of its right
/// edge.
Scene torn_patch(Index cells, Index patch) {
  Scene scene;
  const double h = 50.0 / cells, edge = h * patch;
  scene.mesh = structured_board({cells, cells, 1, 50, 50, 2.5}, [edge](const Vec3& x) {
    return x.x() > 50 - edge && std::abs(x.y() - 25) < edge / 2 ? "patch" : "organ";
  });
  scene.materials = {{"patch", {5, 0.4, 2.0}}, {"organ", {5, 0.4, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  scene.solver.backend = "cpu";
  scene.solver.route = Route::condensed;
  return scene;
}

/// Its elements row by row from the middle, from the edge inwards.
std::vector<Index> tear_of_patch(const Problem& problem) {
  const Mesh& mesh = problem.mesh();
  std::vector<Index> order;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (problem.breakable(e)) order.push_back(e);
  }
  std::ranges::sort(order, {}, [&](Index e) {
    const Vec3 c = centroid(mesh, e);
    return std::pair(std::round(std::abs(c.y() - 25.01)), -c.x());
  });
  return order;
}

// What a long tear makes worse on a large region is found and mended there: no frame solves for the
// whole body again, and few look at all of the region.
TEST(CondensedRoute, ChecksALongTearOnItsRegionAlone) {
  const Body body(torn_patch(71, 24));
  const auto force = corner_force(body.problem->mesh());
  body.load(force);
  const double residual = body.backend->solve().residual;  // of the full check
  int mended = 0;
  const auto order = tear_of_patch(*body.problem);
  for (const Index& e : std::span(order).first(560)) {
    body.backend->destroy({&e, 1});
    body.load(force);
    const SolveReport report = body.backend->solve();
    EXPECT_EQ(report.residual, residual) << "another full check";
    EXPECT_LE(report.error, 1e-8);
    mended += report.back_solves > 1 ? 1 : 0;
  }
  EXPECT_GT(mended, 0) << "the bound by energy has sufficed all along: a test of nothing";
  EXPECT_LE(mended, 28) << "a frame in twenty";
  expect_agreement(body, force, body.backend->destroyed(), kCrackTolerance);
}

// A base made beside the frames was checked as it was begun; 96 events later it may give a
// hundredfold more wrong than then.
TEST(CondensedRoute, SaysWhatAWornBaseGivesWrong) {
  const Body body(torn_patch(18, 12));
  const auto force = corner_force(body.problem->mesh());
  body.load(force);
  body.backend->solve();
  const auto order = tear_of_patch(*body.problem);
  int bases = 0, after_a_base = 0;
  for (std::size_t i = 0; i < 500; ++i) {
    body.backend->destroy({&order[i], 1});
    body.load(force);
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, 1e-8) << i;
    after_a_base = body.backend->take_new_bases().count > 0 ? 0 : after_a_base + 1;
    bases += after_a_base == 0 ? 1 : 0;
    if (bases == 0 || (after_a_base != 0 && after_a_base != 7 && after_a_base != 40)) continue;
    const auto right = yardstick(*body.problem, body.backend->destroyed(), force, {});
    EXPECT_LE(stress_error(body.backend->destroyed(), body.stress(), right.stress),
              report.error + kIntactTolerance)
        << i;
  }
  EXPECT_GE(bases, 4);
}

/// Two cuts through what nobody expected to break, 144 elements, that leave the board in one piece.
std::vector<Index> cuts_beyond(const Mesh& mesh) {
  std::vector<Index> order;
  for (const double y : {10.1, 40.1}) {
    const auto across = elements_across(mesh, y);
    order.insert(order.end(), across.begin(), across.end() - 12);
  }
  return order;
}

// Columns that a thread has by the time and those that the frame solves for have the same bits: a
// host that rests between its events sees what one that does not sees.
TEST(CondensedRoute, WandersBeyondItsRegionThroughNewBases) {
  const auto force = corner_force(torn_organ().mesh);
  const auto order = cuts_beyond(torn_organ().mesh);
  ASSERT_EQ(order.size(), 144u);
  std::vector<std::vector<double>> seen;
  for (const bool rests : {false, true}) {
    const Body body(torn_organ());
    body.load(force);
    int bases = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      SCOPED_TRACE(i);
      body.backend->destroy({&order[i], 1});
      EXPECT_LE(body.backend->solve().error, kCrackTolerance);
      bases += body.backend->take_new_bases().count;
      if (rests) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (i % 48 != 47) continue;
      if (rests) {
        EXPECT_EQ(body.displacement(), seen[i / 48]);
      } else {
        seen.push_back(body.displacement());
        expect_agreement(body, force, body.backend->destroyed(), kCrackTolerance);
      }
    }
    EXPECT_EQ(bases, 1);
  }
}

// A frame that repeats the residual of the one before has had no check over the whole body.
TEST(CondensedRoute, SeldomChecksTheWholeBodyWhileTheLoadTurns) {
  const Body body(organ({"", true, 1}));
  const auto sequence = crack_sequence(*body.problem, 24, 12);
  int full = 0;
  double last = -1;
  for (int i = 0; i < 24; ++i) {
    const double angle = 0.2 * i;
    const auto force = pull(body.problem->mesh(),
                            Vec3(std::sin(angle), -std::cos(angle), 0.05 * std::sin(2.3 * angle)));
    body.load(force);
    const std::size_t event = static_cast<std::size_t>(i);
    body.backend->destroy(std::span(sequence).subspan(event, 1));
    const SolveReport report = body.backend->solve();
    EXPECT_LE(report.error, kCrackTolerance);
    full += report.residual != last;
    last = report.residual;
    if (i % 6 == 5) {
      expect_agreement(body, force, body.backend->destroyed(), kCrackTolerance);
    }
  }
  EXPECT_GE(full, 3) << "one for each axis";
  EXPECT_LE(full, 8);
}

// Fields outside the region are solved for late; they must be those of the solve they belong to.
TEST(CondensedRoute, ReadsTheStressOfTheLastStressCallEverywhere) {
  const Body body(torn_organ());
  auto force = corner_force(body.problem->mesh());
  body.load(force);
  for (int k = 0; k < 2; ++k) {  // the first solution has had a full check, the second has not
    const auto sequence = crack_sequence(*body.problem, 4, 12);
    body.backend->destroy(std::span(sequence).subspan(2 * static_cast<std::size_t>(k), 2));
    body.backend->solve();
    const auto destroyed = body.backend->destroyed();
    const auto reference = plain::Body(*body.problem, destroyed).stress(body.displacement());
    body.backend->stress();
    for (double& f : force) f *= 1.5;
    body.load(force);
    body.backend->solve();
    std::vector<Voigt> stress(body.problem->mesh().tets.size());
    body.backend->read_stress(stress);
    EXPECT_LE(stress_error(destroyed, stress, reference), kIntactTolerance);
    EXPECT_LE(displacement_error(body.problem->mesh(), destroyed, body.displacement(),
                                 yardstick(*body.problem, destroyed, force).displacement),
              kCrackTolerance);
  }
}

TEST(CondensedRoute, SolvesTheIntactBodyEverywhere) {
  const Body body(organ({"", true, 1}));
  const auto force = corner_force(body.problem->mesh());
  body.load(force);
  const auto sequence = crack_sequence(*body.problem, 20, 12);
  body.backend->destroy(sequence);
  body.backend->solve();
  std::vector<double> u(body.problem->dofs().size());
  body.backend->solve_pristine(load_of(*body.problem, force, {}), u);
  const std::vector<std::uint8_t> none(body.problem->mesh().tets.size(), 0);
  const auto intact = yardstick(*body.problem, none, force);
  EXPECT_LE(displacement_error(body.problem->mesh(), none, u, intact.displacement),
            kIntactTolerance);
}

// 366 unknowns of the strip and the pulled corner; 756 elements between them.
TEST(CondensedRoute, HoldsOnlyWhatItsRegionNeeds) {
  const Body body(organ({"", true, 1}));
  std::size_t inverse = 0, stress = 0, whole = 0;
  for (const BufferPlan& b : body.backend->buffers()) {
    if (b.name == "condensed inverse (dense, |S| x |S|)") inverse = b.bytes;
    if (b.name == "element stress") stress = b.bytes;
    if (b.name.starts_with("fields outside")) whole = b.bytes;
    EXPECT_NE(b.name, "inverse (dense, n x n)");
  }
  EXPECT_EQ(inverse, 366u * 366u * 8u);
  EXPECT_EQ(stress, 3u * 14u * 6u * sizeof(Voigt));
  EXPECT_EQ(whole, 0u) << "nobody has asked yet";
}

}  // namespace
}  // namespace sunder::test
