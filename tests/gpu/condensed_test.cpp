// SPDX-License-Identifier: Apache-2.0
// Route condensed on Vulkan against the CPU reference, which computes the whole body: a strip of a
// larger board can tear, and the device has the strip alone.
#include <algorithm>
#include <chrono>
#include <thread>

#include "body/pieces.hpp"
#include "gpu_body.hpp"
#include "organ.hpp"
#include "sunder/error.hpp"
#include "support/yardstick.hpp"

namespace sunder::test {
namespace {

/// What is destroyed or has come loose.
std::vector<std::uint8_t> ignore_loose(const Backend& backend) {
  std::vector<std::uint8_t> ignored(backend.destroyed().begin(), backend.destroyed().end());
  for (const auto& piece : find_loose_parts(backend.problem(), backend.destroyed()).pieces) {
    for (Index e : piece) ignored[static_cast<std::size_t>(e)] = 1;
  }
  return ignored;
}

std::vector<Way> condensed_ways() {
  std::vector<Way> ways = all_ways();
  std::erase_if(ways, [](const Way& way) { return way.update == Update::eager; });
  for (const gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    ways.push_back({.variant = variant, .region = true});
    ways.push_back({.variant = variant, .region = true, .damage = true});
  }
  for (Way& way : ways) way.route = Route::condensed;
  return ways;
}

class CondensedOnVulkan : public WithVulkan<testing::TestWithParam<Way>> {
 protected:
  [[nodiscard]] double allowed(double of_fp64) const {
    return GetParam().precision == Precision::fp64 ? of_fp64 : kFp32Tolerance;
  }
  static void expect(const Pair::Errors& e, double allowed, const std::string& where) {
    EXPECT_TRUE(e.u <= allowed) << where << ": displacement error " << e.u;
    EXPECT_TRUE(e.stress <= allowed) << where << ": stress error " << e.stress;
    EXPECT_EQ(e.summary.any.element, e.reference_summary.any.element) << where;
    EXPECT_NEAR(e.summary.any.ratio, e.reference_summary.any.ratio,
                10 * allowed * e.reference_summary.any.ratio)
        << where;
  }
  void follow(Pair& pair, const std::vector<Index>& sequence, double tolerance) {
    std::size_t done = 0;
    for (std::size_t count : {1, 10, 50, 100, 180}) {
      ASSERT_LE(count, sequence.size());
      for (; done < count; ++done) pair.destroy({&sequence[done], 1});
      expect(pair.solve(), allowed(tolerance), std::to_string(count) + " fractures");
    }
  }
};

TEST_P(CondensedOnVulkan, AlongACrack) {
  Scene scene = organ();
  add_pull(scene);
  Pair pair(std::move(scene), GetParam());
  EXPECT_EQ(pair.vulkan->info().route, "condensed");
  EXPECT_EQ(std::ranges::count(pair.vulkan->buffers(), "inverse of the region (device)",
                               &BufferPlan::name),
            GetParam().region ? 1 : 0);
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kIntactTolerance), "intact");
  follow(pair, crack_sequence(pair.problem(), 180, 12), kCrackTolerance);
}

TEST_P(CondensedOnVulkan, AgreesWithTheYardstick) {
  Scene scene = organ();
  add_pull(scene);
  Pair pair(std::move(scene), GetParam());
  pair.load(corner_pull(pair.problem()));
  pair.destroy(crack_sequence(pair.problem(), 50, 12));
  pair.solve();
  const auto ignored = pair.vulkan->destroyed();
  const auto right = yardstick(pair.problem(), ignored, corner_force(pair.problem().mesh()));
  EXPECT_LE(displacement_error(pair.problem().mesh(), ignored, Pair::displacement(*pair.vulkan),
                               right.displacement),
            allowed(kCrackTolerance));
  EXPECT_LE(stress_error(ignored, Pair::stress(*pair.vulkan), right.stress),
            allowed(kCrackTolerance));
}

// Over a contrast of 1e4 or a ratio of .499 a frame keeps the scene's tolerance, by a margin of 20.
TEST_P(CondensedOnVulkan, StiffAndNearlyIncompressible) {
  struct Case {
    double contrast, poisson;
  };
  for (const auto& [contrast, poisson] :
       {Case{1e4, 0.4}, Case{1, 0.499}, Case{1e6, 0.4}, Case{1, 0.4999}, Case{1e5, 0.4999},
        Case{1e4, 0.49999}, Case{1e6, 0.4999}}) {
    Scene scene = organ(contrast, poisson);
    add_pull(scene);
    Pair pair(std::move(scene), GetParam());
    pair.load(corner_pull(pair.problem()));
    const auto sequence = crack_sequence(pair.problem(), 50, 12);
    for (std::size_t done = 0; done < 50; done += 10) {
      pair.destroy(std::span(sequence).subspan(done, 10));
    }
    const bool named = contrast <= 1e4 && poisson <= 0.499;  // by the table of accuracy
    // Only the first frame after an event is refined.
    const double else_within = GetParam().damage ? 5e-5 : 5e-6;
    expect(pair.solve(), allowed(named ? kCrackTolerance : else_within),
           "contrast " + std::to_string(contrast) + ", Poisson's ratio " + std::to_string(poisson));
  }
}

// Nothing keeps the loaded corner in the region: its forces reach it through the rest.
TEST_P(CondensedOnVulkan, LoadedOutsideTheRegion) {
  Pair pair(organ(), GetParam());
  pair.load(corner_pull(pair.problem()));
  expect(pair.solve(), allowed(kIntactTolerance), "intact");
  pair.destroy(crack_sequence(pair.problem(), 10, 12));
  expect(pair.solve(), allowed(kCrackTolerance), "10 fractures");
}

TEST_P(CondensedOnVulkan, Grips) {
  for (const bool supported : {true, false}) {
    Scene scene = organ();
    add_pull(scene);
    Instrument low, high;
    low.name = "low";
    low.action = Grip{Box{Vec3(-0.1, -0.1, -1), Vec3(0.1, 10.1, 4)}, Vec3(-0.5, 0.25, 0), Axes{7}};
    scene.instruments.push_back(low);
    if (!supported) {  // the grips alone hold the body
      scene.supports.clear();
      high.name = "high";
      high.action = Grip{Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Vec3(0, 0, 0), Axes{7}};
      scene.instruments.push_back(high);
    }
    Pair pair(std::move(scene), GetParam());
    Load load = corner_pull(pair.problem());
    for (std::size_t i = 0; i < load.displacements.size(); ++i) {
      load.displacements[i] = 0.1 * static_cast<double>(i % 7) - 0.2;
    }
    pair.load(load);
    expect(pair.solve(), allowed(kIntactTolerance), "intact");
    pair.destroy(crack_sequence(pair.problem(), 20, 12));
    expect(pair.solve(), allowed(kCrackTolerance), "20 fractures");
    pair.expect_reactions(allowed(kCrackTolerance));
  }
}

TEST_P(CondensedOnVulkan, AfterACut) {
  Pair pair(organ(), GetParam());
  const Mesh& mesh = pair.problem().mesh();
  auto force =
      shared_force(mesh, nodes_in(mesh, {Vec3(49.9, 39, -1), Vec3(51, 41, 3)}), Vec3(6, 0, 0));
  const auto below = corner_force(mesh, Vec3(0, -6e-3, 0));
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += below[i];
  pair.load(load_of(pair.problem(), force, {}));
  for (Index e : elements_across(mesh, 26.5)) pair.destroy({&e, 1});
  const auto ignored = ignore_loose(*pair.vulkan);
  const auto errors = pair.solve(ignored);
  EXPECT_LE(errors.u, allowed(kCutTolerance));
  EXPECT_LE(errors.stress, allowed(kCutTolerance));
  for (double u : Pair::displacement(*pair.vulkan)) ASSERT_TRUE(std::isfinite(u));
}

// The unknowns that the host keeps grow then; the device keeps the region.
TEST_P(CondensedOnVulkan, DestroysOutsideTheRegion) {
  Scene scene = organ();
  add_pull(scene);
  Instrument grip;
  grip.name = "grip";
  grip.action = Grip{Box{Vec3(-0.1, -0.1, -1), Vec3(0.1, 10.1, 4)}, Vec3(-0.5, 0.25, 0), Axes{7}};
  scene.instruments.push_back(grip);
  Pair pair(std::move(scene), GetParam());
  Load load = corner_pull(pair.problem());
  for (double& d : load.displacements) d = 0.05;
  pair.load(load);
  const auto sequence = crack_sequence(pair.problem(), 40, 12);
  for (std::size_t i = 0; i < 15; ++i) pair.destroy(std::span(sequence).subspan(i, 1));
  pair.solve();
  const Index worst = pair.vulkan->stress().candidate.element;
  for (Backend* b : {pair.reference.get(), pair.vulkan.get()}) b->exclude_candidates({&worst, 1});
  const auto u = Pair::displacement(*pair.vulkan);
  const auto outside = elements_across(pair.problem().mesh(), 10.1);
  ASSERT_FALSE(pair.problem().breakable(outside.front()));
  // A host may say so before: a thread begins with what the region lacks.
  const auto has_begun = [&] {
    return std::ranges::count(pair.vulkan->buffers(), "columns that the region may grow by",
                              &BufferPlan::name) > 0;
  };
  EXPECT_FALSE(has_begun());
  pair.vulkan->prepare(std::span(outside).first(5));
  for (int i = 0; i < 1000 && !has_begun(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(has_begun());
  pair.destroy(std::span(outside).first(5));
  const auto kept = Pair::displacement(*pair.vulkan);
  EXPECT_LE(displacement_error(pair.problem().mesh(), pair.vulkan->destroyed(), kept, u), 1e-12);
  const auto errors = pair.solve();
  expect(errors, allowed(kCrackTolerance), "outside");
  EXPECT_EQ(errors.summary.candidate.element, errors.reference_summary.candidate.element);
  EXPECT_NE(errors.summary.candidate.element, worst);
  pair.destroy(std::span(sequence).subspan(15, 25));
  pair.destroy(std::span(outside).subspan(5, 2));
  expect(pair.solve(), allowed(kCrackTolerance), "outside and along the crack");
  pair.expect_reactions(allowed(kCrackTolerance));
}

TEST_P(CondensedOnVulkan, IntactBodyAndSingleReads) {
  Scene scene = organ();
  add_pull(scene);
  Pair pair(std::move(scene), GetParam());
  const Load load = corner_pull(pair.problem());
  pair.load(load);
  pair.destroy(crack_sequence(pair.problem(), 5, 12));
  pair.solve();
  const auto u = Pair::displacement(*pair.vulkan);
  std::vector<Index> nodes;
  for (Index n = 0; n < pair.problem().node_count(); n += 3) nodes.push_back(n);
  std::vector<Vec3> some(nodes.size());
  pair.vulkan->read_displacement(nodes, some);
  for (std::size_t i = 0; i < nodes.size(); ++i) EXPECT_EQ(some[i], Vec3(&u[3 * nodes[i]]));
  const auto stress = Pair::stress(*pair.vulkan);
  for (Index e = 0; e < pair.problem().tet_count(); e += 7) {
    EXPECT_EQ(pair.vulkan->read_stress(e), stress[static_cast<std::size_t>(e)]);
  }
  std::vector<double> intact(u.size()), reference(u.size());
  pair.vulkan->solve_pristine(load, intact);
  pair.reference->solve_pristine(load, reference);
  const std::vector<std::uint8_t> none(pair.problem().mesh().tets.size(), 0);
  EXPECT_LE(displacement_error(pair.problem().mesh(), none, intact, reference), kIntactTolerance);
}

INSTANTIATE_TEST_SUITE_P(All, CondensedOnVulkan, testing::ValuesIn(condensed_ways()),
                         [](const auto& tested) { return name_of(tested.param); });

class CondensedChoice : public WithVulkan<> {};

// 366 of 1800 unknowns: the strip and the pulled corner; 252 of 1680 elements.
TEST_F(CondensedChoice, HoldsTheRegionAlone) {
  Scene scene = organ();
  add_pull(scene);
  scene.fracture.model = FractureModel::a;
  Way way{.precision = Precision::fp32, .update = Update::automatic, .route = Route::automatic};
  const auto bytes = [](const Backend& backend) {
    std::size_t inverse = 0, stress = 0;
    for (const BufferPlan& b : backend.buffers()) {
      if (b.name == "condensed inverse (dense, |S| x |S|)") inverse = b.bytes;
      if (b.name == "element stress (device)") stress = b.bytes;
    }
    return std::pair(inverse, stress);
  };
  const WatchedBackend watched(std::move(scene), way);
  const auto backend = watched.create();
  EXPECT_EQ(backend->info().route, "condensed");
  EXPECT_EQ(backend->info().update, "deferred");
  EXPECT_NE(backend->info().why.find("366 can break"), std::string::npos) << backend->info().why;
  const auto [inverse, stress] = bytes(*backend);
  EXPECT_EQ(inverse, 366u * 366u * 8u);
  EXPECT_EQ(stress, 256u * 8u * 4u);
  std::string left_out;
  for (const std::string& what : backend->needs().left_out) left_out += what + "\n";
  EXPECT_NE(left_out.find("inverse of the other 1434 unknowns"), std::string::npos) << left_out;
  EXPECT_NE(left_out.find("stress of the other 1428 elements"), std::string::npos) << left_out;
}

// Method B reads the intact body's field and the nodes round its cracks as well.
TEST_F(CondensedChoice, TearsAsTheCpuDoes) {
  for (const FractureModel model : {FractureModel::a, FractureModel::b}) {
    Scene scene = organ();
    add_pull(scene, -300);
    scene.instruments.front().ramp = Ramp{0, 1};
    scene.fracture.model = model;
    scene.fracture.max_events = 12;
    scene.steps = 6;
    Scene whole = scene;
    whole.solver.route = Route::inverse;
    const auto on_cpu = std::make_shared<const Problem>(std::move(whole));
    const auto reference = destroyed_by(on_cpu, cpu_reference::create(on_cpu, needs_of(*on_cpu)));
    EXPECT_GE(reference.size(), 10u);
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      const WatchedBackend watched(
          scene, {.precision = precision, .update = Update::automatic, .route = Route::automatic});
      auto backend = watched.create();
      EXPECT_EQ(backend->info().route, "condensed");
      EXPECT_EQ(destroyed_by(watched.problem, std::move(backend)), reference);
    }
  }
}

TEST_F(CondensedChoice, HasNoEagerUpdate) {
  const WatchedBackend watched(organ(), {.update = Update::eager, .route = Route::condensed});
  const std::string message = message_of([&] { static_cast<void>(watched.create()); });
  EXPECT_NE(message.find("use update deferred or auto, or route inverse"), std::string::npos)
      << message;
}

// A crack destroys an inverse in single precision that events write over (docs/method.md).
TEST_F(CondensedChoice, TakesDoublePrecisionForTheEagerUpdate) {
  const WatchedBackend single(organ(), {.precision = Precision::fp32, .update = Update::eager});
  const std::string message = message_of([&] { static_cast<void>(single.create()); });
  EXPECT_NE(message.find("use precision fp64 or auto, or update deferred"), std::string::npos)
      << message;
  const WatchedBackend open(organ(), {.precision = Precision::automatic, .update = Update::eager});
  EXPECT_EQ(open.create()->info().precision, "fp64");
}

TEST_F(CondensedChoice, NeedsSomethingToCondenseTo) {
  Scene scene = organ();
  Way way{.update = Update::automatic, .route = Route::condensed};
  for (auto& [name, material] : scene.materials) material.yield.reset();
  const WatchedBackend unbreakable(scene, way);
  EXPECT_THROW(static_cast<void>(unbreakable.create()), DeviceError);
}

}  // namespace
}  // namespace sunder::test
