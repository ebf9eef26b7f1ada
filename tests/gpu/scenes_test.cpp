// SPDX-License-Identifier: Apache-2.0
// Every scene of scenes/ on Vulkan breaks the elements that the CPU reference breaks, in the same
// events. Where a ratio is so near the limit that rounding decides, the lists may part: the test
// then says where and why, and holds the error of the fields on the reference's list instead.
#include <algorithm>
#include <filesystem>
#include <set>

#include "app/input/scene_toml.hpp"
#include "body/pieces.hpp"
#include "fracture_lists.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::test {
namespace {

std::set<std::string> scene_names() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SUNDER_SCENES)) {
    if (entry.path().extension() == ".toml") names.insert(entry.path().stem());
  }
  return names;
}

Scene scene_of(const std::string& name) {
  return app::read_problem(std::filesystem::path(SUNDER_SCENES) / (name + ".toml"), {})->scene();
}

constexpr std::size_t kTableFractures = 200;  // as far as the accuracy table goes

/// Relative to the largest stress, by the accuracy table.
double table_error(Precision precision) { return precision == Precision::fp64 ? 1e-8 : 1e-4; }

Fractures run(std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> backend) {
  Simulation simulation(std::move(problem), std::move(backend));
  while (!simulation.done()) simulation.step();
  return simulation.destroyed();
}

/// What the reference knows of elements at a decision: run again up to there.
std::function<Yielding(Index)> yielding_at(const std::shared_ptr<const Problem>& problem,
                                           const Parting& parting, double error) {
  std::vector<Voigt> stress(problem->mesh().tets.size(), Voigt::Zero());
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  simulation.observe_frames([&] {
    if (simulation.steps_done() != parting.step) return;
    if (simulation.destroyed().size() == parting.before) stress = simulation.stress();
  });
  while (simulation.steps_done() <= parting.step) simulation.step();
  double largest = 0;
  for (const Voigt& s : stress) largest = std::max(largest, tensor_norm(s));
  // The measure (s1 - s3)/2 moves by no more than the norm of the stress error.
  const bool tresca = problem->scene().fracture.yield_measure == YieldMeasure::tresca;
  return [=](Index e) {
    const double measure = (tresca ? 2 : 1) * max_shear(stress[static_cast<std::size_t>(e)]);
    return Yielding{measure / problem->yield(e), error * largest / problem->yield(e)};
  };
}

/// The reference's fractures fed to both, under the pulls of the scene's end.
void expect_fields_on_one_list(const Scene& scene, const Way& way, const Fractures& list,
                               double allowed) {
  Pair pair(scene, way);
  std::vector<double> force(3 * pair.problem().mesh().nodes.size(), 0.0);
  for (std::size_t i = 0; i < scene.instruments.size(); ++i) {
    const auto* action = std::get_if<Pull>(&scene.instruments[i].action);
    if (!action) continue;
    const auto shared = shared_force(pair.problem().mesh(),
                                     pair.problem().instrument_nodes()[i].nodes, action->force);
    for (std::size_t j = 0; j < force.size(); ++j) force[j] += shared[j];
  }
  pair.load(load_of(pair.problem(), force,
                    std::vector<double>(pair.problem().gripped_dofs().size(), 0.0)));
  double worst_u = 0, worst_stress = 0;
  std::size_t i = 0;
  while (i < std::min<std::size_t>(list.size(), kTableFractures)) {
    std::vector<Index> event;
    for (const int of = list[i].event; i < list.size() && list[i].event == of; ++i) {
      event.push_back(list[i].element);
    }
    pair.destroy(event);
    // A piece cut off under load has no displacement to compare.
    if (!find_loose_parts(pair.problem(), pair.reference->destroyed()).pieces.empty()) break;
    const auto errors = pair.solve();
    EXPECT_TRUE(errors.u <= allowed) << i << " fractures: displacement error " << errors.u;
    EXPECT_TRUE(errors.stress <= allowed) << i << " fractures: stress error " << errors.stress;
    worst_u = std::max(worst_u, errors.u);
    worst_stress = std::max(worst_stress, errors.stress);
  }
  std::printf("on the reference's list, %zu fractures: errors of u up to %.1e, of stress %.1e\n", i,
              worst_u, worst_stress);
}

/// Fails unless the lists are one, or part at a ratio within the band. `tears`: whether any must
/// break.
void expect_same_fractures(const Scene& scene, const Way& way, std::optional<bool> tears = {}) {
  Scene on_cpu = scene;
  on_cpu.solver = {.backend = "cpu"};
  const auto reference = std::make_shared<const Problem>(on_cpu);
  const Fractures expected = run(reference, cpu_reference::create(reference, needs_of(*reference)));
  const WatchedBackend vulkan(scene, way);
  const Fractures list = run(vulkan.problem, vulkan.create());
  testing::Test::RecordProperty("fractures", static_cast<int>(expected.size()));
  if (tears) {
    EXPECT_EQ(!expected.empty(), *tears) << "fractures: " << expected.size();
  }
  const auto at = parting(expected, list);
  if (!at) return;
  const double allowed = table_error(way.precision);
  const std::string why = excuse(*at, expected, list, yielding_at(reference, *at, allowed));
  ASSERT_NE(why, "") << "the lists part after " << at->index << " of " << expected.size()
                     << " fractures, in step " << at->step << ", where no ratio is near the limit";
  std::printf("the lists part after %zu of %zu fractures: %s\n", at->index, expected.size(),
              why.c_str());
  testing::Test::RecordProperty("parts", why);
  expect_fields_on_one_list(scene, way, expected, allowed);
}

class Scenes : public WithVulkan<testing::TestWithParam<std::tuple<std::string, Way>>> {};

TEST_P(Scenes, BreakTheElementsThatTheReferenceBreaks) {
  const auto& [name, way] = GetParam();
  const Scene scene = scene_of(name);
  const bool breakable = std::any_of(scene.materials.begin(), scene.materials.end(),
                                     [](const auto& m) { return m.second.yield.has_value(); });
  expect_same_fractures(scene, way, breakable);
}

std::vector<Way> scene_ways() {
  std::vector<Way> ways;
  for (gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    for (Precision precision : {Precision::fp32, Precision::fp64}) {
      ways.push_back({variant, precision, Update::automatic});
    }
  }
  return ways;
}

INSTANTIATE_TEST_SUITE_P(All, Scenes,
                         testing::Combine(testing::ValuesIn(scene_names()),
                                          testing::ValuesIn(scene_ways())),
                         [](const auto& tested) {
                           std::string name = std::get<0>(tested.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name + "_" + name_of(std::get<1>(tested.param));
                         });

/// Scenes in motion, their first steps, both promised far better than what they may be apart by.
class MotionScenes : public WithVulkan<testing::TestWithParam<std::string>> {};

TEST_P(MotionScenes, GoAsTheReferenceGoes) {
  constexpr int kSteps = 6;
  Scene scene = scene_of("motion/" + GetParam());
  scene.solver = {.backend = "cpu", .tolerance = 1e-10};
  const auto reference = std::make_shared<const Problem>(scene);
  const WatchedBackend vulkan(scene, {.precision = Precision::fp64, .tolerance = 1e-10});
  std::vector<std::vector<Vec3>> u;
  std::vector<std::vector<Voigt>> stress;
  Fractures expected;
  for (const bool on_device : {false, true}) {
    Simulation simulation(
        on_device ? vulkan.problem : reference,
        on_device ? vulkan.create() : cpu_reference::create(reference, needs_of(*reference)));
    EXPECT_EQ(simulation.backend().info().backend, on_device ? "vulkan" : "cpu");
    for (int i = 0; i < kSteps; ++i) simulation.step();
    u.push_back(simulation.displacement());
    stress.push_back(simulation.stress());
    if (on_device) {
      EXPECT_FALSE(parting(expected, simulation.destroyed()));
    }
    expected = simulation.destroyed();
  }
  std::vector<std::uint8_t> gone(scene.mesh.tets.size(), 0);
  for (const DestroyedElement& d : expected) gone[static_cast<std::size_t>(d.element)] = 1;
  const auto values = [](const std::vector<Vec3>& of) {
    return std::span<const double>(of.front().data(), 3 * of.size());
  };
  const double of_u = displacement_error(scene.mesh, gone, values(u[1]), values(u[0])),
               of_stress = stress_error(gone, stress[1], stress[0]);
  std::printf("%zu gone: errors of u %.1e, of stress %.1e\n", expected.size(), of_u, of_stress);
  EXPECT_LE(of_u, kCrackTolerance);
  EXPECT_LE(of_stress, kCrackTolerance);
}

/// What both promise a step leaves them so far apart after some dozens of steps.
TEST_P(MotionScenes, TearAsTheReferenceTears) {
  const int kSteps = GetParam() == "liver" ? 12 : 60;
  constexpr double kApart = 1e-6;
  Scene scene = scene_of("motion/" + GetParam());
  scene.steps = std::min(scene.steps, kSteps);
  scene.solver = {.backend = "cpu", .tolerance = 1e-9};
  const auto reference = std::make_shared<const Problem>(scene);
  const WatchedBackend vulkan(scene, {.precision = Precision::fp64, .tolerance = 1e-9});
  const Fractures expected = run(reference, cpu_reference::create(reference, needs_of(*reference)));
  const Fractures list = run(vulkan.problem, vulkan.create());
  const auto at = parting(expected, list);
  const std::size_t same = at ? at->index : expected.size();
  std::printf("%zu of %zu ruptures are the same\n", same, expected.size());
  EXPECT_GE(same, 8u);
  if (!at) return;
  const std::string why = excuse(*at, expected, list, yielding_at(reference, *at, kApart));
  EXPECT_NE(why, "") << "the lists part in step " << at->step << " far from the limit";
  std::printf("there %s\n", why.c_str());
}

INSTANTIATE_TEST_SUITE_P(All, MotionScenes, testing::Values("board", "sheet", "liver"),
                         [](const auto& tested) { return tested.param; });

/// The yield that the worst element of the board reaches to within a part in 1e12.
TEST(ScenesAtTheLimit, PartOnlyWithinTheBandAndSayWhy) {
  if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
  Scene scene = pulled_board(Vec3(0, -40, 0));
  scene.fracture.model = FractureModel::a;
  scene.fracture.max_events = 10;
  const auto problem = std::make_shared<const Problem>(scene);
  const auto backend = cpu_reference::create(problem, needs_of(*problem));
  backend->set_load(corner_pull(*problem, Vec3(0, -40, 0)));
  backend->solve();
  const double ratio = backend->stress().any.ratio;
  for (const double off : {0.0, 1e-12}) {
    for (auto& [name, material] : scene.materials) {
      if (material.yield) *material.yield *= ratio * (1 + off);
    }
    for (const Precision precision : {Precision::fp32, Precision::fp64}) {
      expect_same_fractures(scene, {.precision = precision, .update = Update::automatic});
    }
    for (auto& [name, material] : scene.materials) {
      if (material.yield) *material.yield /= ratio * (1 + off);
    }
  }
}

DestroyedElement broken(int step, int event, Index element, Cause cause = Cause::mss,
                        double ratio = 1.5) {
  DestroyedElement d;
  d.step = step;
  d.event = event;
  d.element = element;
  d.cause = cause;
  d.ratio = ratio;
  return d;
}

std::string excuse_of(const Fractures& a, const Fractures& b,
                      const std::map<Index, double>& ratios) {
  const auto at = parting(a, b);
  if (!at) return "no parting";
  return excuse(*at, a, b, [&](Index e) { return Yielding{ratios.at(e), 1e-3}; });
}

TEST(FractureLists, PartWhereTheyFirstDiffer) {
  const Fractures a = {broken(0, 0, 5), broken(1, 1, 7, Cause::sif), broken(1, 1, 8, Cause::sif)};
  EXPECT_FALSE(parting(a, a));
  Fractures b = a;
  b[2].element = 9;
  const auto p = parting(a, b);
  ASSERT_TRUE(p);
  EXPECT_EQ(p->index, 2u);
  EXPECT_EQ(p->before, 1u);  // the event's two elements were decided together
  EXPECT_EQ(p->step, 1);
  b = a;
  b[1].crack = 0;
  EXPECT_EQ(parting(a, b)->index, 1u);
  EXPECT_EQ(parting(a, {a[0]})->index, 1u);
  EXPECT_EQ(parting({}, a)->step, 0);
}

TEST(FractureLists, MayPartOnlyInsideTheBand) {
  const Fractures a = {broken(0, 0, 5)};
  EXPECT_EQ(excuse_of(a, a, {}), "no parting");
  // Another element: a tie or a fault.
  EXPECT_NE(excuse_of(a, {broken(0, 0, 6)}, {{5, 1.5}, {6, 1.4995}}), "");
  EXPECT_EQ(excuse_of(a, {broken(0, 0, 6)}, {{5, 1.5}, {6, 1.4}}), "");
  // None, or later: at the limit or a fault.
  for (const Fractures& b : {Fractures{}, Fractures{broken(1, 0, 5)}, Fractures{broken(1, 0, 6)}}) {
    EXPECT_NE(excuse_of(a, b, {{5, 1.0005}, {6, 1.2}}), "");
    EXPECT_NE(excuse_of(b, a, {{5, 0.9995}, {6, 1.2}}), "");
    EXPECT_EQ(excuse_of(a, b, {{5, 1.01}, {6, 1.2}}), "");
    EXPECT_EQ(excuse_of(b, a, {{5, 0.99}, {6, 1.2}}), "");
  }
  // A tip's reach.
  const Fractures reached = {broken(0, 0, 5, Cause::sif, 1 + 1e-7)};
  EXPECT_NE(excuse_of(reached, {}, {}), "");
  EXPECT_NE(excuse_of(reached, {broken(0, 0, 6)}, {{6, 1.3}}), "");
  EXPECT_EQ(excuse_of({broken(0, 0, 5, Cause::sif, 1.1)}, {}, {}), "");
  // Scripts and presets never depend on rounding; NaN excuses nothing.
  EXPECT_EQ(excuse_of({broken(0, 0, 5, Cause::script)}, {}, {{5, 1}}), "");
  EXPECT_EQ(excuse_of(a, {}, {{5, std::nan("")}}), "");
}

}  // namespace
}  // namespace sunder::test
