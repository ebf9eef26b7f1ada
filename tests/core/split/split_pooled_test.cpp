// SPDX-License-Identifier: Apache-2.0
// Boards of pooled volume that a crack splits: against the same board as a mesh whose faces are
// open, with the patches that are left of it; what is taken back; whole runs on both routes.
#include <cmath>
#include <cstdio>

#include "body/pieces.hpp"
#include "body/pools.hpp"
#include "core/fracture/board_fixture.hpp"
#include "split_against_fresh.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

struct PooledCase {
  Route route;
  MaterialLaw law;
  double poisson;
  bool notch;
};

std::string name_of_pooled(const ::testing::TestParamInfo<PooledCase>& info) {
  const PooledCase& c = info.param;
  return std::string(c.route == Route::inverse ? "Inverse" : "Factor") +
         (c.law == MaterialLaw::linear ? "Linear" : "NeoHookean") +
         std::to_string(std::lround(1000 * c.poisson)) + (c.notch ? "Notch" : "");
}

constexpr double kLawTolerance = 1e-7;

Scene scene_of(const PooledCase& c, Mesh mesh) {
  Scene scene = scene_of(SplitCase{c.route, false, c.poisson, c.notch}, std::move(mesh));
  scene.materials["board"].volume = MaterialVolume::pooled;
  scene.materials["board"].law = c.law;
  if (c.law != MaterialLaw::linear) scene.solver.tolerance = kLawTolerance;
  return scene;
}

/// The board as a mesh whose faces are open, every node with unknowns of its own.
std::shared_ptr<const Problem> opened(const Problem& whole, const EdgeSplit& crack) {
  std::vector<NodeThatParts> nodes;
  for (Index n = whole.node_count(); n < crack.body.node_count(); ++n) {
    NodeThatParts node{crack.body.in_mesh(n), Axes{0}};
    for (int axis = 0; axis < 3; ++axis) {
      const bool free = whole.dof(node.parent, axis) != kNone;
      node.axes.bits = static_cast<std::uint8_t>(node.axes.bits | (free ? 1U << axis : 0U));
    }
    nodes.push_back(node);
  }
  const auto corners = crack.body.corners();
  return std::make_shared<const Problem>(
      whole, std::vector<std::array<Index, 4>>(corners.begin(), corners.end()), nodes);
}

/// All that can be read of a body: at every node, those that have come too, and element.
struct Read {
  explicit Read(const Backend& backend)
      : u(3 * static_cast<std::size_t>(backend.node_count())),
        stress(static_cast<std::size_t>(backend.problem().tet_count())) {
    std::vector<Index> nodes(u.size() / 3);
    std::iota(nodes.begin(), nodes.end(), 0);
    std::vector<Vec3> at(nodes.size());
    backend.read_displacement(nodes, at);
    for (std::size_t i = 0; i < at.size(); ++i) std::copy_n(at[i].data(), 3, &u[3 * i]);
    backend.read_stress(stress);
  }
  bool operator==(const Read&) const = default;
  std::vector<double> u;
  std::vector<Voigt> stress;
};

class PooledSplit : public ::testing::TestWithParam<PooledCase> {};

INSTANTIATE_TEST_SUITE_P(
    All, PooledSplit,
    ::testing::Values(PooledCase{Route::factor, MaterialLaw::linear, 0.3, false},
                      PooledCase{Route::factor, MaterialLaw::linear, 0.49, true},
                      PooledCase{Route::inverse, MaterialLaw::linear, 0.49, false},
                      PooledCase{Route::factor, MaterialLaw::neo_hookean, 0.3, true},
                      PooledCase{Route::factor, MaterialLaw::neo_hookean, 0.49, true},
                      PooledCase{Route::inverse, MaterialLaw::neo_hookean, 0.45, false}),
    name_of_pooled);

TEST_P(PooledSplit, FollowsACrackAsAFreshBodyWithOpenFacesSays) {
  const PooledCase& c = GetParam();
  const bool linear = c.law == MaterialLaw::linear;
  const double close = linear ? kCrackTolerance : 10 * kLawTolerance;
  std::mt19937 random(7);
  const auto problem = std::make_shared<const Problem>(
      scene_of(c, shaken_board({12, 10, 2, 12, 10, 2}, random, 0.2)));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  const std::vector<double> force =
      shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, kBy);
  EdgeSplit crack(*problem);
  std::vector<Index> gone;
  const auto solve = [&](Backend& of) {
    std::vector<double> all = force;
    all.resize(of.problem().dofs().size(), 0.0);
    of.set_load(load_of(of.problem(), all, {}));
    EXPECT_LE(of.solve().error, linear ? 1e-8 : kLawTolerance);
    static_cast<void>(of.stress());
    return Read(of);
  };
  const auto expect_as_fresh = [&](int step) {
    const auto fresh_problem = opened(*problem, crack);
    const auto fresh = cpu_reference::create(fresh_problem, needs_of(*fresh_problem));
    fresh->set_load({});
    if (!gone.empty()) fresh->destroy(gone);
    const Read expected = solve(*fresh), found = solve(*backend);
    EXPECT_LE(displacement_error(fresh_problem->mesh(), crack.destroyed, found.u, expected.u),
              close)
        << step;
    EXPECT_LE(stress_error(crack.destroyed, found.stress, expected.stress), close) << step;
  };
  const auto first = crack.begin(0.1);
  ASSERT_TRUE(first.moved());
  backend->set_load(load_of(*problem, force, {}));
  backend->change(first.change);
  expect_as_fresh(0);
  std::uniform_real_distribution<double> kink(-0.3, 0.3);
  for (int i = 1; i <= 7; ++i) {
    const auto step = crack.advance(kink(random));
    ASSERT_TRUE(step.moved() && !step.through) << i;
    backend->change(step.change);
    if (c.notch && i == 4) {  // behind the tip elements leave patches that are split already
      for (Index e = 0; e < problem->tet_count() && gone.size() < 4; ++e) {
        if ((crack.board.centroid(e) - crack.crack.path.front()).norm() < 2) gone.push_back(e);
      }
      for (Index e : gone) crack.destroyed[static_cast<std::size_t>(e)] = 1;
      backend->destroy(gone);
    }
    if (i % 3 == 1) expect_as_fresh(i);
  }
}

/// A board of law linear under its load, with a crack that has begun.
struct CrackedBoard {
  CrackedBoard(Route route, double poisson, const BoardShape& shape)
      : problem(std::make_shared<const Problem>(
            scene_of(PooledCase{route, MaterialLaw::linear, poisson, false}, shaken(shape)))),
        backend(cpu_reference::create(problem, needs_of(*problem))),
        force(shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, kBy)),
        crack(*problem) {
    load();
    backend->change(crack.begin(0).change);
  }
  static Mesh shaken(const BoardShape& shape) {
    std::mt19937 random(7);
    return shaken_board(shape, random, 0.2);
  }
  void load() const { backend->set_load(load_of(*problem, force, {})); }
  /// Of the last solution, with stress; `gone`: what is destroyed.
  void expect_as_fresh(std::span<const Index> gone, std::span<const std::uint8_t> ignored) const {
    const auto opened_problem = opened(*problem, crack);
    const auto fresh = cpu_reference::create(opened_problem, needs_of(*opened_problem));
    std::vector<double> all = force;
    all.resize(opened_problem->dofs().size(), 0.0);
    fresh->set_load(load_of(*opened_problem, all, {}));
    fresh->destroy(gone);
    static_cast<void>(fresh->solve());
    static_cast<void>(fresh->stress());
    const Read expected(*fresh), found(*backend);
    EXPECT_LE(displacement_error(opened_problem->mesh(), ignored, found.u, expected.u),
              kCrackTolerance);
    EXPECT_LE(stress_error(ignored, found.stress, expected.stress), kCrackTolerance);
  }
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<Backend> backend;
  std::vector<double> force;
  EdgeSplit crack;
};

/// Past new bases, which take over what has parted: their patches are those that are left.
TEST(PooledCracks, ALongCrackIsAsAFreshBodySays) {
  CrackedBoard board(Route::factor, 0.49, {45, 6, 2, 45, 6, 2});
  const auto& backend = board.backend;
  for (int i = 1; i <= 30; ++i) {
    auto step = board.crack.advance(0);
    ASSERT_TRUE(step.moved() && !step.through) << i;
    step.change.held = true;
    backend->change(step.change);
    board.load();
    EXPECT_LE(backend->solve().error, 1e-8) << i;
    static_cast<void>(backend->stress());
  }
  EXPECT_TRUE(std::ranges::any_of(backend->buffers(), [](const BufferPlan& b) {
    return b.name.starts_with("damaged factor");
  })) << "no new base on the way";
  board.expect_as_fresh({}, board.crack.destroyed);
}

/// What meets an element that shares its patch with another that it does not meet, all of it whole
/// and far from a crack: without it the element is a piece of its own.
std::vector<Index> ring_far_from(const Problem& problem, const EdgeSplit& crack) {
  const auto& tets = problem.mesh().tets;
  const auto meet = [&](Index a, Index b) {
    return std::ranges::find_first_of(tets[static_cast<std::size_t>(a)],
                                      tets[static_cast<std::size_t>(b)]) !=
           tets[static_cast<std::size_t>(a)].end();
  };
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto patch = problem.pools()->elements(problem.pools()->of(e));
    if (std::ranges::all_of(patch, [&](Index other) { return meet(e, other); })) continue;
    std::vector<Index> ring;
    bool far = true;
    for (Index other = 0; other < problem.tet_count(); ++other) {
      if (other == e || !meet(e, other)) continue;
      ring.push_back(other);
      far = far && (crack.board.centroid(other) - crack.crack.path.front()).norm() > 5 &&
            crack.body.corners()[static_cast<std::size_t>(other)] ==
                tets[static_cast<std::size_t>(other)];
    }
    if (far) return ring;
  }
  return {};
}

/// A piece comes off beside a crack of split nodes, which goes on: patches are split by both.
TEST(PooledCracks, APieceBesideACrackSharesNoPressure) {
  for (Route route : {Route::factor, Route::inverse}) {
    CrackedBoard board(route, 0.4, {12, 10, 2, 12, 10, 2});
    Backend& backend = *board.backend;
    EdgeSplit& crack = board.crack;
    for (int i = 1; i <= 3; ++i) backend.change(crack.advance(0).change);
    const std::vector<Index> ring = ring_far_from(*board.problem, crack);
    ASSERT_FALSE(ring.empty());
    const Index split_by_crack = backend.pools()->count();
    const std::size_t half = ring.size() / 2;
    backend.destroy(std::span(ring).first(half));
    backend.destroy(std::span(ring).subspan(half));
    EXPECT_GT(backend.pools()->count(), split_by_crack);
    EXPECT_GT(split_by_crack, board.problem->pools()->count());
    for (Index e : ring) crack.destroyed[static_cast<std::size_t>(e)] = 1;
    for (int i = 1; i <= 2; ++i) backend.change(crack.advance(0).change);
    board.load();
    EXPECT_LE(backend.solve().error, 1e-8);
    static_cast<void>(backend.stress());
    const auto parted = opened(*board.problem, crack);
    LooseSearch search(*parted);
    search.look(crack.destroyed);
    std::vector<std::uint8_t> ignored(crack.destroyed.begin(), crack.destroyed.end());
    for (Index e = 0; e < parted->tet_count(); ++e) {
      if (search.piece_of(e) != kNone) ignored[static_cast<std::size_t>(e)] = 1;
    }
    board.expect_as_fresh(ring, ignored);
  }
}

/// Where a crack splits a patch its parts had changed their volume by as much in the mean alone:
/// each now has a pressure of its own, which takes energy that the patch did not have. Nothing
/// pushes, so momentum stays.
TEST(PooledCracks, APartedPatchGivesItsBodyEnergyButNoMomentum) {
  std::mt19937 random(3);
  Scene scene = scene_of(PooledCase{Route::factor, MaterialLaw::neo_hookean, 0.49, false},
                         shaken_board({10, 8, 2, 10, 8, 2}, random, 0.2));
  scene.supports.clear();
  scene.instruments.clear();
  scene.materials["board"].density = 1e-9;
  scene.dynamics = Dynamics{.time_step = 1e-3};
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  std::vector<double> v;
  for (const Vec3& x : problem->mesh().nodes) {
    const Vec3 of = Vec3(30, 20, 0) + Vec3(0, 0, 2).cross(x) + Vec3(0, 300 * (x.x() - 5), 0);
    v.insert(v.end(), of.begin(), of.end());
  }
  backend->set_load({});
  backend->set_velocity(v);
  static_cast<void>(backend->advance(1e-3));
  const MotionState begin = backend->motion();
  EdgeSplit crack(*problem);
  double given = 0;
  for (int i = 0; i < 6; ++i) {
    const auto step = i == 0 ? crack.begin(0) : crack.advance(0.1);
    ASSERT_TRUE(step.moved());
    const MotionState before = backend->motion();
    fem::Change change = step.change;
    change.held = true;
    backend->change(change);
    const MotionState after = backend->motion();
    EXPECT_NEAR(after.kinetic, before.kinetic, 1e-12 * before.kinetic);
    EXPECT_LE((after.angular_momentum - before.angular_momentum).norm(),
              1e-12 * before.angular_momentum.norm());
    EXPECT_GE(after.strain_energy, before.strain_energy * (1 - 1e-12));  // U is convex
    given += after.strain_energy - before.strain_energy;
    static_cast<void>(backend->advance(1e-3));
  }
  const MotionState end = backend->motion();
  EXPECT_LE((end.momentum - begin.momentum).norm(), 1e-9 * begin.momentum.norm());
  std::printf("six partings give %.3g N mm to a body of %.3g\n", given, begin.kinetic);
  EXPECT_GT(given, 0);
  EXPECT_NEAR(end.kinetic + end.strain_energy + end.dissipated() - given, end.work,
              1e-6 * std::abs(begin.kinetic));
}

class PooledHistory : public ::testing::TestWithParam<Route> {};

INSTANTIATE_TEST_SUITE_P(All, PooledHistory, ::testing::Values(Route::factor, Route::inverse),
                         [](const ::testing::TestParamInfo<Route>& of) {
                           return of.param == Route::inverse ? "Inverse" : "Factor";
                         });

TEST_P(PooledHistory, StepsAreTakenBackBitForBit) {
  std::mt19937 random(7);
  const auto problem = std::make_shared<const Problem>(
      scene_of(PooledCase{GetParam(), MaterialLaw::linear, 0.49, false},
               shaken_board({12, 10, 2, 12, 10, 2}, random, 0.2)));
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  const std::vector<double> force =
      shared_force(problem->mesh(), problem->instrument_nodes()[0].nodes, kBy);
  EdgeSplit crack(*problem);
  const auto look = [&] {
    backend->set_load(load_of(*problem, force, {}));
    static_cast<void>(backend->solve());
    static_cast<void>(backend->stress());
    return Read(*backend);
  };
  std::vector<fem::Change> changes;
  std::vector<Read> read{look()};
  std::vector<std::shared_ptr<const BackendState>> states{backend->save()};
  for (std::size_t i = 0; i < 7; ++i) {
    const auto step = i == 0 ? crack.begin(0.1) : crack.advance(0.1);
    ASSERT_TRUE(step.moved() && !step.through) << i;
    changes.push_back(step.change);
    backend->change(step.change);
    read.push_back(look());
    states.push_back(backend->save());
  }
  for (const std::size_t at : {6U, 3U, 0U}) {
    ASSERT_TRUE(states[at]) << at;
    ASSERT_TRUE(backend->restore(*states[at])) << at;
    EXPECT_TRUE(Read(*backend) == read[at]) << at;
    EXPECT_TRUE(look() == read[at]) << at << ", solved again";
  }
  for (std::size_t i = 0; i < changes.size(); ++i) {
    backend->change(changes[i]);
    EXPECT_TRUE(look() == read[i + 1]) << i << ", again";
  }
}

/// The notched board at nu .49, by either way of a crack.
std::vector<DestroyedElement> rows_of(Route route, CrackWay way, SifSource sif) {
  Scene scene = notch_board(FractureModel::b);
  scene.fracture.crack = way;
  scene.fracture.sif = sif;
  scene.fracture.max_events = 3;
  scene.solver.route = route;
  for (auto& [name, material] : scene.materials) {
    material.volume = MaterialVolume::pooled;
    material.poisson = 0.49;
  }
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation run(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!run.done() && run.cracks().size() < 2 && run.destroyed().size() < 40) {
    EXPECT_LE(run.step().error, 1e-8);
  }
  // Supports hold what pulls, by the patches' pressures in the body as it has parted.
  const Vec3 pulled = run.reactions().front();
  EXPECT_LE((run.support_reaction() + pulled).norm(), 1e-6 * pulled.norm());
  return run.destroyed();
}

TEST(PooledCracks, RunAlikeOnBothRoutes) {
  for (const auto& [way, sif] : {std::pair{CrackWay::split, SifSource::field},
                                 std::pair{CrackWay::destroyed, SifSource::field},
                                 std::pair{CrackWay::destroyed, SifSource::formula}}) {
    const auto factor = rows_of(Route::factor, way, sif),
               inverse = rows_of(Route::inverse, way, sif);
    ASSERT_EQ(factor.size(), inverse.size());
    int grown = 0;
    for (std::size_t i = 0; i < factor.size(); ++i) {
      EXPECT_EQ(factor[i].element, inverse[i].element) << i;
      EXPECT_EQ(factor[i].crack, inverse[i].crack) << i;
      if (!factor[i].sif) continue;
      ++grown;
      EXPECT_NEAR(factor[i].sif->k, inverse[i].sif->k, 1e-7 * factor[i].sif->k) << i;
    }
    EXPECT_GE(grown, 3);
  }
}

}  // namespace
}  // namespace sunder::test
