// SPDX-License-Identifier: Apache-2.0
// The device's cost model orders frames as they are, and its terms are those of the passes.
#include <gtest/gtest.h>

#include "gpu/plan_device.hpp"
#include "solver/route_table.hpp"

namespace sunder::test {
namespace {

using solver::FrameCost;
using solver::FrameShape;

solver::FrameRates device(VkPhysicalDeviceType type) {
  vulkan::PhysicalDevice device;
  device.type = type;
  return gpu::plan_device(device, false).rates;
}

/// A board of `n` unknowns.
FrameShape board(std::size_t n) {
  FrameShape shape;
  shape.apart = shape.damage = shape.stress = true;
  shape.unknowns = shape.kept = n;
  shape.loaded = 6;
  shape.exact_loads = 64;
  shape.elements = shape.stressed = n;
  shape.real_bytes = 4;
  shape.stiffness_bytes = 500 * n;
  return shape;
}

constexpr VkPhysicalDeviceType kKinds[] = {VK_PHYSICAL_DEVICE_TYPE_CPU,
                                           VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
                                           VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU};

TEST(DeviceCostModel, OrdersFrames) {
  for (const VkPhysicalDeviceType kind : kKinds) {
    FrameShape eager = board(6000), cg = board(6000), organ = board(1000);
    eager.eager = true;
    cg.route = Route::cg;
    const FrameCost deferred = frame_cost(board(6000), device(kind));
    EXPECT_GT(deferred.quiet.ms, 0);
    EXPECT_GT(deferred.fracture.ms, deferred.quiet.ms);
    EXPECT_GT(frame_cost(eager, device(kind)).fracture.ms, deferred.fracture.ms);
    EXPECT_GT(frame_cost(cg, device(kind)).fracture.ms, deferred.fracture.ms);
    EXPECT_LT(frame_cost(organ, device(kind)).fracture.ms, deferred.fracture.ms);
  }
}

TEST(DeviceCostModel, CountsWhatASceneNeeds) {
  FrameShape quiet = board(3000), gripped = board(3000), loaded = board(3000);
  quiet.damage = false;
  gripped.grips = 60;
  loaded.loaded = 3000;
  const auto lavapipe = device(VK_PHYSICAL_DEVICE_TYPE_CPU);
  const double least = frame_cost(quiet, lavapipe).quiet.ms;
  EXPECT_EQ(frame_cost(quiet, lavapipe).fracture.ms, 0);
  EXPECT_GT(frame_cost(gripped, lavapipe).quiet.ms, least) << "reactions are f - K u";
  EXPECT_GT(frame_cost(loaded, lavapipe).quiet.ms, least);
}

// Half of the inverse is read and written once: 4 n^2 bytes in fp32.
TEST(DeviceCostModel, AnEagerUpdateIsBoundByTheInverse) {
  FrameShape small = board(6000), large = board(24000);
  small.eager = large.eager = true;
  const auto gpu = device(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU);
  const double ratio = frame_cost(large, gpu).fracture.ms / frame_cost(small, gpu).fracture.ms;
  EXPECT_GT(ratio, 8);
  EXPECT_LT(ratio, 16);
}

// Of an element: shape 96 bytes, corners 16, state 16, the
// displacement of four nodes 128, stress 8 values; f - K u reads the stiffness; columns are fp64.
TEST(DeviceCostModel, CountsTheBytesOfAFrame) {
  FrameShape shape = board(1024);
  const auto gpu = device(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU);
  const double columns = 6 * 1024 * 8;
  const double state = 1024 * (96 + 16 + 16 + 128 + 8 * 4);
  EXPECT_EQ(frame_cost(shape, gpu).quiet.bytes, columns + state);
  // 12 unknowns more in u = X f, and f - K u.
  EXPECT_EQ(frame_cost(shape, gpu).fracture.bytes, 3 * columns + state + 500 * 1024);
  shape.real_bytes = 8;
  EXPECT_EQ(frame_cost(shape, gpu).quiet.bytes, columns + state + 1024 * 8 * 4);
}

// Of boards with stiff frames on lavapipe (bench_scaling): solution alone, nodes and groups.
TEST(DeviceCostModel, CountsIterationsByTheGroups) {
  struct Board {
    std::size_t nodes, groups;
    double iterations;
  };
  for (const Board& b :
       {Board{200, 12, 233}, Board{722, 45, 132}, Board{2738, 171, 102}, Board{10368, 648, 95},
        Board{40328, 1260, 121}, Board{168200, 5256, 176}, Board{336200, 10506, 163}}) {
    FrameShape shape = board(3 * b.nodes);
    shape.groups = b.groups;
    const double ratio = iterations_apart(shape) / b.iterations;
    EXPECT_GT(ratio, .7) << b.nodes;
    EXPECT_LT(ratio, 1.4) << b.nodes;
  }
}

// What a host's factor solves for an event's columns; an inverse that the host has kept is read.
TEST(DeviceCostModel, CountsTheHostsColumns) {
  FrameShape kept = board(6000), factored = board(6000);
  factored.entries = 1'000'000;
  const auto gpu = device(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU);
  EXPECT_GT(frame_cost(factored, gpu).fracture.ms, frame_cost(kept, gpu).fracture.ms + 1);
  EXPECT_EQ(frame_cost(factored, gpu).quiet.ms, frame_cost(kept, gpu).quiet.ms);
}

// A load that has only grown takes steps along solutions that are known.
TEST(DeviceCostModel, AQuietFrameOfConjugateGradientsIteratesNot) {
  FrameShape cg = board(6000);
  cg.route = Route::cg;
  const FrameCost cost = frame_cost(cg, device(VK_PHYSICAL_DEVICE_TYPE_CPU));
  EXPECT_LT(20 * cost.quiet.ms, cost.fracture.ms);
}

// By the bytes a second that products with them reach (docs/vulkan.md).
TEST(DeviceCostModel, SmallMatricesAreWorthADeviceWhereTheyAreLarge) {
  EXPECT_EQ(solver::columns_worth_a_device(gpu::rates_of_a_gpu(400e9, 300e9)), 576);
  EXPECT_EQ(solver::columns_worth_a_device(gpu::rates_of_a_gpu(2e12, 10e12)), 384);
  EXPECT_EQ(solver::columns_worth_a_device(device(VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU)),
            std::nullopt);
}

TEST(DeviceCostModel, AGpuIsQuickerOnLargeBodies) {
  const FrameCost lavapipe = frame_cost(board(30000), device(VK_PHYSICAL_DEVICE_TYPE_CPU));
  const FrameCost gpu = frame_cost(board(30000), device(VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU));
  EXPECT_GT(lavapipe.quiet.ms, 5 * gpu.quiet.ms);
}

}  // namespace
}  // namespace sunder::test
