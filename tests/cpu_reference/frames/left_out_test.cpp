// SPDX-License-Identifier: Apache-2.0
// What a scene does not need does not exist: neither in the list of buffers nor on the heap.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "sunder/simulation.hpp"
#include "support/body.hpp"
#include "support/heap.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

// What the allocator itself keeps back or rounds up; every buffer looked for here is larger.
constexpr std::size_t kSlack = 64 << 10;
constexpr std::size_t kStress = 1954 * sizeof(Voigt);
constexpr const char* kKernel = "shapes and elasticity of elements";

struct Held {
  std::size_t heap = 0;
  std::vector<BufferPlan> buffers;
  [[nodiscard]] std::size_t of(const std::string& name) const {
    for (const BufferPlan& b : buffers) {
      if (b.name == name) return b.bytes;
    }
    return 0;
  }
};

/// What a backend holds after a frame, with a fracture if one can be.
Held held(const Needs& needs, Route route = Route::factor, Update update = Update::automatic) {
  Scene scene = pulled_board();
  scene.solver.route = route;
  scene.solver.update = update;
  const auto problem = std::make_shared<Problem>(std::move(scene));
  const std::size_t before = heap_in_use();
  const auto backend = cpu_reference::create(problem, needs);
  backend->set_load(corner_pull(*problem));
  if (needs.damage) backend->destroy(std::vector<Index>{700});
  backend->solve();
  if (needs.stress) backend->stress();
  return {heap_in_use() - before, backend->buffers()};
}

// The check of a frame takes the largest stress and K u with the kernel, and keeps neither.
TEST(LeftOut, StressBuffersWhenNobodyNeedsStress) {
  Needs needs;
  const Held without = held(needs);
  needs.stress = true;
  const Held with = held(needs);
  EXPECT_EQ(with.of("element stress"), kStress);
  EXPECT_EQ(without.of("element stress"), 0u);
  EXPECT_EQ(without.of("element stress of the next frame"), 0u);
  // With stress it keeps bounds of strain and rotation, too, and what is cut off.
  EXPECT_LT(without.of(kKernel), with.of(kKernel));
  EXPECT_LE(with.of(kKernel), without.of(kKernel) + without.of(kKernel) / 40);
  EXPECT_GE(with.heap + kSlack, without.heap + 2 * kStress);
}

TEST(LeftOut, StressKernelOfARouteThatChecksWithoutIt) {
  Needs needs;
  needs.damage = true;
  const auto compare = [&](Route route, Update update) {
    needs.stress = false;
    const Held without = held(needs, route, update);
    needs.stress = true;
    const Held with = held(needs, route, update);
    EXPECT_EQ(without.of(kKernel), 0u) << without.heap;
    EXPECT_GT(with.of(kKernel), 1954u * 100);
    EXPECT_GE(with.heap + kSlack, without.heap + 2 * kStress + with.of(kKernel));
  };
  compare(Route::inverse, Update::eager);
  compare(Route::cg, Update::automatic);
}

// A frame that keeps no stress is checked by the same sums: nothing but the stress is missing.
TEST(LeftOut, StressAloneWhenNobodyNeedsStress) {
  for (Route route : {Route::inverse, Route::factor}) {
    Scene scene = pulled_board();
    scene.solver.route = route;
    Needs needs;
    const Body without(scene, needs);
    needs.stress = true;
    const Body with(std::move(scene), needs);
    Load load = corner_pull(*with.problem);
    for (int frame = 0; frame < 3; ++frame) {
      for (double& f : load.forces) f *= 1.25;
      SolveReport report[2];
      for (const Body* body : {&without, &with}) {
        body->backend->set_load(load);
        report[body == &with] = body->backend->solve();
      }
      EXPECT_EQ(report[0].error, report[1].error);
      EXPECT_EQ(report[0].residual, report[1].residual);
      EXPECT_EQ(without.displacement(), with.displacement());
    }
  }
}

TEST(LeftOut, RoomForDamageWhenNothingCanBreak) {
  Needs needs;
  needs.stress = true;
  const Held without = held(needs);
  needs.damage = true;
  const Held with = held(needs);
  EXPECT_GT(with.of("update vectors along the elimination paths"), 0u);
  EXPECT_EQ(without.of("update vectors along the elimination paths"), 0u);
  EXPECT_EQ(without.of("small matrix of the damage"), 0u);
  // Three square matrices for the first thousand differences.
  EXPECT_GE(with.heap + kSlack, without.heap + 3u * 1000 * 1000 * 8);
}

// A pressed crack needs to know the elements around each node; a pull by the same force does not.
TEST(LeftOut, PressureTermsWithoutPressure) {
  const auto made = [](bool press, std::vector<std::string>& left_out) {
    Scene scene;
    scene.mesh = structured_board({60, 60, 1, 50, 50, 2});
    scene.materials["board"] = {5, 0.4, 2.0};
    scene.supports.push_back({top_edge(), Axes{7}});
    scene.solver.backend = "cpu";
    scene.solver.route = Route::factor;
    PresetCrack crack;
    crack.elements = std::vector<Index>{60 * 30 * 6};
    crack.mouth = Vec3(0, 25, 1);
    crack.tips = {Vec3(0.8, 25, 1)};
    scene.cracks.push_back(crack);
    Instrument tool;
    tool.name = "tool";
    if (press) {
      Press action;
      action.at = Vec3(0, 25, 1);
      action.force = Vec3(0, -1, 0);
      tool.action = action;
    } else {
      tool.action = Pull{Box{Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0.1, 2.1)}, Vec3(0, -1, 0)};
    }
    scene.instruments.push_back(tool);
    const auto problem = std::make_shared<Problem>(std::move(scene));
    Needs needs = needs_of(*problem);
    left_out = needs.left_out;
    auto backend = cpu_reference::create(problem, std::move(needs));
    const std::size_t before = heap_in_use();
    const Simulation simulation(problem, std::move(backend));
    return heap_in_use() - before;
  };
  const auto has = [](const std::vector<std::string>& list) {
    return std::ranges::count(list, "pressure terms K_b, K_c: no pressing instrument") == 1;
  };
  std::vector<std::string> of_pull, of_press;
  const std::size_t pull = made(false, of_pull), press = made(true, of_press);
  EXPECT_TRUE(has(of_pull));
  EXPECT_FALSE(has(of_press));
  // Four nodes of each of 21,600 elements.
  EXPECT_GE(press + kSlack, pull + 21600u * 4 * sizeof(Index));
}

TEST(LeftOut, EverythingThatNobodyAsksForTogether) {
  const Held least = held({});
  std::size_t planned = 0;
  for (const BufferPlan& b : least.buffers) planned += b.bytes;
  // What is on the heap beyond the list: the body's flags, the list of all unknowns, work space.
  EXPECT_LE(least.heap, planned + 256 * 1954) << planned;
}

}  // namespace
}  // namespace sunder::test
