// SPDX-License-Identifier: Apache-2.0
// Forces of the grips between frames on Vulkan: the block of the CPU reference within the accuracy
// table, and answers for another thread while frames tear the body.
#include "sunder/instrument_forces.hpp"

#include <cmath>

#include "failover_backend.hpp"
#include "gpu_body.hpp"
#include "solver/instrument_block.hpp"
#include "support/haptic_reader.hpp"

namespace sunder::test {
namespace {

/// A board of which the lower half can tear, 1,500 elements; gripped at its lower right corner.
Scene gripped_board(bool supported = true) {
  Scene scene;
  scene.mesh = structured_board({10, 10, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() > 22 && x.y() < 33 ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, 0.4, 2.0}}, {"organ", {8, 0.4, std::nullopt}}};
  const Box top{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)};
  Instrument low, high;
  low.name = "low";
  low.action = Grip{lower_right_corner(), Vec3(0.25, 0.25, 0.25), Axes{7}};
  scene.instruments.push_back(low);
  if (supported) {
    scene.supports.push_back({top, Axes{7}});
  } else {  // the grips alone hold the body, by anchors in K0
    high.name = "high";
    high.action = Grip{top, Vec3(0, 0, 0), Axes{7}};
    scene.instruments.push_back(high);
  }
  return scene;
}

std::vector<Way> block_ways() {
  std::vector<Way> ways;
  for (Route route : {Route::inverse, Route::condensed}) {
    for (Precision precision : {Precision::fp32, Precision::fp64}) {
      ways.push_back({.precision = precision, .route = route});
    }
    ways.push_back({.precision = Precision::fp32, .route = route, .float64 = false});
  }
  ways.push_back({.update = Update::eager});
  return ways;
}

class InstrumentsOnVulkan : public WithVulkan<testing::TestWithParam<Way>> {};

void expect_near(std::span<const double> values, std::span<const double> reference, double allowed,
                 const char* what) {
  double largest = 0;
  for (double v : reference) largest = std::max(largest, std::abs(v));
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(values[i], reference[i], allowed * largest) << what << ", grip " << i;
  }
}

TEST_P(InstrumentsOnVulkan, AreThoseOfTheCpu) {
  const double allowed = GetParam().precision == Precision::fp64 ? kCrackTolerance : kFp32Tolerance;
  for (const bool supported : {true, false}) {
    Pair pair(gripped_board(supported), GetParam());
    const auto block = pair.vulkan->instrument_forces();
    const auto reference = pair.reference->instrument_forces();
    ASSERT_TRUE(block && reference);
    const std::size_t grips = pair.problem().gripped_dofs().size();
    std::vector<double> held(grips), elsewhere(grips), forces(grips, -1), of_cpu(grips);
    for (std::size_t g = 0; g < grips; ++g) {
      held[g] = 0.05 * static_cast<double>(g % 5);
      elsewhere[g] = 0.1 * static_cast<double>(g % 4) - 0.1;  // no rigid motion
    }
    EXPECT_FALSE(block->forces(held, forces)) << "before the first frame";
    EXPECT_EQ(forces, std::vector<double>(grips, 0.0));
    pair.load({{}, {}, held});
    const auto sequence = crack_sequence(pair.problem(), 40, 8);
    for (std::size_t done = 0; done < 40; done += 10) {
      pair.destroy(std::span(sequence).subspan(done, 10));
      pair.solve();
      ASSERT_TRUE(block->forces(held, forces));
      std::vector<double> reactions(grips);
      pair.vulkan->read_reactions(reactions);
      expect_near(forces, reactions, 1e-9, "the frame's own");
      for (const auto& d : {held, elsewhere}) {
        ASSERT_TRUE(block->forces(d, forces));
        ASSERT_TRUE(reference->forces(d, of_cpu));
        expect_near(forces, of_cpu, allowed, "the CPU's block");
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, InstrumentsOnVulkan, testing::ValuesIn(block_ways()),
                         [](const auto& tested) {
                           return name_of(tested.param) +
                                  (tested.param.route == Route::condensed ? "_condensed" : "");
                         });

class InstrumentBlock : public WithVulkan<> {};

TEST_F(InstrumentBlock, AnswersAnotherThreadWhileFramesTear) {
  Pair pair(gripped_board(), {.precision = Precision::fp32});
  const auto block = pair.vulkan->instrument_forces();
  const std::size_t grips = pair.problem().gripped_dofs().size();
  const std::vector<double> held(grips, 0.25);
  HapticReader reader(*block, held);
  Pulls frames;
  std::vector<double> reactions(grips);
  pair.vulkan->set_load({{}, {}, held});
  for (Index e : crack_sequence(pair.problem(), 40, 8)) {
    pair.vulkan->destroy({&e, 1});
    pair.vulkan->solve();
    pair.vulkan->read_reactions(reactions);
    frames.add(reactions);
  }
  const Pulls answers = reader.end();
  EXPECT_EQ(answers.bad, 0);
  EXPECT_EQ(block->frames(), 40u);
  EXPECT_GE(answers.least, frames.least * (1 - 1e-9));
  EXPECT_LE(answers.most, frames.most * (1 + 1e-9));
}

TEST_F(InstrumentBlock, IsThereAtOnceAfterASolve) {
  Pair pair(gripped_board(), {});
  const std::size_t grips = pair.problem().gripped_dofs().size();
  const std::vector<double> held(grips, 0.25);
  pair.load({{}, {}, held});
  pair.solve();
  std::vector<double> forces(grips), reactions(grips);
  EXPECT_TRUE(pair.vulkan->instrument_forces()->forces(held, forces));
  pair.vulkan->read_reactions(reactions);
  expect_near(forces, reactions, 1e-9, "of the last solve");
}

TEST_F(InstrumentBlock, GoesOnWithTheCpuWhenTheDeviceIsLost) {
  WatchedBackend watched(gripped_board(), {});
  watched.options.probe.submits_until_lost = 40;
  const auto backend = with_failover(watched.problem, watched.create(all_needs()), [&] {
    Scene scene = gripped_board();
    scene.solver = {};
    return cpu_reference::create(std::make_shared<Problem>(std::move(scene)), all_needs());
  });
  const auto block = backend->instrument_forces();
  const std::size_t grips = watched.problem->gripped_dofs().size();
  const std::vector<double> held(grips, 0.25);
  std::vector<double> forces(grips), reactions(grips);
  backend->set_load({{}, {}, held});
  for (Index e : crack_sequence(*watched.problem, 40, 8)) {
    backend->destroy({&e, 1});
    backend->solve();
    ASSERT_TRUE(block->forces(held, forces));
    backend->read_reactions(reactions);
    expect_near(forces, reactions, 1e-8, "before and after");
  }
  EXPECT_EQ(backend->info().backend, "cpu");
}

}  // namespace
}  // namespace sunder::test
