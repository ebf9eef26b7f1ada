// SPDX-License-Identifier: Apache-2.0
// One rule for every device: what differs is what the device says of itself.
#include "solver/plan.hpp"

#include <gtest/gtest.h>

#include <set>

#include "solver/route_table.hpp"
#include "sunder/error.hpp"
#include "support/loads.hpp"
#include "support/structured_board.hpp"
#include "support/text.hpp"

namespace sunder::solver {
namespace {

using test::mentions;

constexpr std::size_t kPlenty = std::size_t{1} << 34;

PlanDevice host(std::size_t memory = kPlenty) {
  PlanDevice device;
  device.backend = "cpu";
  device.routes = {Route::inverse, Route::condensed, Route::factor, Route::cg};
  device.memory = memory;
  return device;
}

PlanDevice apart(std::size_t memory = kPlenty) {
  PlanDevice device;
  device.backend = "vulkan";
  device.name = "a device";
  device.routes = {Route::inverse, Route::condensed, Route::cg};
  device.memory = memory;
  device.fp32 = true;
  device.rates.bytes = 1e11;
  return device;
}

/// A board of which the lower part, up to a height, can tear.
Scene board(Index cells, double height = 11) {
  Scene scene;
  scene.mesh = test::structured_board({cells, cells, 1, 10, 10, 1}, [height](const Vec3& x) {
    return std::string(x.y() < height ? "tissue" : "organ");
  });
  scene.materials["tissue"] = {5, 0.4, 2.0};
  if (height < 10) scene.materials["organ"] = {5, 0.4, std::nullopt};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 11, 2)}, Axes{7}});
  scene.fracture.model = FractureModel::a;
  return scene;
}

Plan plan_of(const Scene& scene, const PlanDevice& device, const Needs& needs = test::all_needs()) {
  return make_plan(Problem(scene), needs, device);
}

template <class Error>
std::string refusal(const Scene& scene, const PlanDevice& device) {
  try {
    static_cast<void>(plan_of(scene, device));
  } catch (const Error& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Plan, HasARowForEveryRoute) {
  std::set<std::string> names;
  for (Route route : {Route::inverse, Route::condensed, Route::factor, Route::cg}) {
    EXPECT_EQ(row_of(route).route, route);
    names.insert(name_of(route));
  }
  EXPECT_EQ(names.size(), routes().size());
  EXPECT_EQ(name_of(Route::automatic), "auto");
}

// 252 * 252 values of 8 bytes; a device that stores them in 4 says so.
TEST(Plan, TakesTheSameRouteForTheSameReasonOnEveryDevice) {
  const Plan on_host = plan_of(board(6), host()), there = plan_of(board(6), apart());
  EXPECT_EQ(on_host.route, Route::inverse);
  EXPECT_EQ(there.route, Route::inverse);
  EXPECT_EQ(on_host.why,
            "252 unknowns: the dense inverse takes 508 kB, and a frame reads only its loaded and "
            "torn columns");
  EXPECT_EQ(there.why,
            "252 unknowns: the dense inverse takes 254 kB, and a frame reads only its loaded and "
            "torn columns; tolerance 0.0001 is kept by fp32 storage with fp64 sums");
  // A region's inverse is the host's, in fp64 whatever the device stores.
  const std::string why =
      "2520 unknowns, of which 630 can break, are loaded or held by instruments: their inverse "
      "takes 3175 kB, and a frame computes nothing else";
  for (const PlanDevice& device : {host(), apart()}) {
    const Plan plan = plan_of(board(20, 2), device);
    EXPECT_EQ(plan.route, Route::condensed);
    EXPECT_TRUE(plan.why.starts_with(why)) << plan.why;
    ASSERT_TRUE(plan.region.has_value());
    EXPECT_EQ(plan.region->dofs.size(), 630u);
    ASSERT_FALSE(plan.left_out.empty());
    EXPECT_TRUE(mentions(plan.left_out[0], "inverse of the other 1890 unknowns"));
  }
}

TEST(Plan, GoesOnToWhatTheDeviceHas) {
  const Scene large = board(32);  // 6336 unknowns
  EXPECT_EQ(plan_of(large, host()).route, Route::factor);
  const Plan there = plan_of(large, apart());
  EXPECT_EQ(there.route, Route::cg);
  EXPECT_TRUE(mentions(there.why, "6336 unknowns: a dense inverse would take 160 MB")) << there.why;
  Needs quiet;
  quiet.stress = true;
  EXPECT_EQ(plan_of(board(6), host(), quiet).route, Route::factor);
  EXPECT_EQ(plan_of(board(6), apart(), quiet).route, Route::inverse) << "it has no factor";
}

// The update that was asked for decides, however large the body is.
TEST(Plan, TakesTheInverseForTheEagerUpdateOnEveryDevice) {
  Scene scene = board(32);  // 6336 unknowns
  scene.solver.update = Update::eager;
  for (const PlanDevice& device : {host(), apart()}) {
    const Plan plan = plan_of(scene, device);
    EXPECT_EQ(plan.route, Route::inverse);
    EXPECT_TRUE(plan.eager);
    EXPECT_TRUE(plan.fp64);
    EXPECT_EQ(name_of_update(plan), "eager");
    EXPECT_TRUE(plan.why.starts_with("update eager was asked for")) << plan.why;
  }
}

TEST(Plan, RefusesWhatTheMemoryDoesNotHold) {
  Scene scene = board(20);  // 2520 unknowns
  scene.solver.route = Route::inverse;
  EXPECT_EQ(refusal<InputError>(scene, host(1000)),
            "route inverse needs 101606400 bytes for 2520 unknowns, but 1000 are free; use route "
            "factor");
  const std::string message =
      "route inverse needs 25401600 bytes for 2520 unknowns, but the device \"a device\" has 1000; "
      "use route cg";
  EXPECT_EQ(refusal<DeviceError>(scene, apart(1000)), message);
  scene.solver.route = Route::automatic;  // hundreds of iterations a frame: not by itself
  EXPECT_EQ(refusal<DeviceError>(scene, apart(1000)), message);
}

TEST(Plan, SaysWhatADeviceOffersInstead) {
  Scene scene = board(6);
  scene.solver.route = Route::factor;
  EXPECT_EQ(refusal<DeviceError>(scene, apart()),
            "backend vulkan offers the routes inverse, condensed and cg; choose one, auto or "
            "backend cpu");
  scene.solver = {};
  scene.solver.precision = sunder::Precision::fp32;
  EXPECT_EQ(refusal<DeviceError>(scene, host()),
            "backend cpu computes in fp64 only; use precision fp64 or auto");
  EXPECT_FALSE(plan_of(scene, apart()).fp64);
  for (const PlanDevice& device : {host(), apart()}) {
    scene.solver = {};
    scene.solver.update = Update::eager;
    scene.solver.route = Route::condensed;
    EXPECT_TRUE(mentions(refusal<DeviceError>(scene, device), "has the update deferred only"));
    scene.solver.route = Route::cg;
    EXPECT_TRUE(mentions(refusal<DeviceError>(scene, device), "has no update to choose"));
  }
}

TEST(Plan, PooledVolumeNextToIncompressibleTakesFp64) {
  Scene scene = board(6);
  PlanDevice device = apart();
  device.fp64 = true;
  for (auto& [name, material] : scene.materials) {
    material.volume = MaterialVolume::pooled;
    material.poisson = 0.499;
  }
  EXPECT_FALSE(plan_of(scene, device).fp64);
  for (auto& [name, material] : scene.materials) material.poisson = 0.4995;
  EXPECT_TRUE(plan_of(scene, device).fp64);
  scene.solver.precision = sunder::Precision::fp32;
  EXPECT_EQ(refusal<DeviceError>(scene, device),
            "precision fp32 does not keep its promise for pooled volume at a Poisson's ratio of "
            "0.4995, over 0.499; use precision fp64 or auto");
  for (auto& [name, material] : scene.materials) material.volume = MaterialVolume::element;
  EXPECT_FALSE(plan_of(scene, device).fp64);
}

TEST(Plan, LeavesTheWholeBodyToAHostThatDrawsIt) {
  PlanDevice shown = apart();
  shown.displayed = true;
  Scene scene = board(20, 2);
  EXPECT_EQ(plan_of(scene, shown).route, Route::inverse);
  scene.solver.route = Route::condensed;
  EXPECT_TRUE(mentions(refusal<DeviceError>(scene, shown), "the host draws those of the whole"));
}

TEST(Plan, SaysThatTheDeviceComputesTheInverse) {
  PlanDevice device = apart();
  EXPECT_FALSE(plan_of(board(6), device).invert_on_device);
  device.inverts_from = 252;
  EXPECT_TRUE(plan_of(board(6), device).invert_on_device);
  EXPECT_TRUE(mentions(plan_of(board(6), device).why, "; the device computes the inverse"));
  EXPECT_FALSE(plan_of(board(20, 2), device).invert_on_device) << "that of a region is the host's";
}

// n^3 operations and 8 n^3 / 60 bytes: 6336 unknowns take .51 s at 500 GFLOP/s and .34 s at 100
// GB/s, and twice as long at half of these rates.
TEST(Plan, TakesALargeInverseThatTheDeviceMakesInTime) {
  const Scene large = board(32);  // 6336 unknowns
  PlanDevice card = apart();
  card.inverts_from = 3000;
  card.rates.flops = 5e11;
  const Plan plan = plan_of(large, card);
  EXPECT_EQ(plan.route, Route::inverse);
  EXPECT_TRUE(plan.invert_on_device);
  EXPECT_TRUE(mentions(plan.why, "by nominal rates the device makes it in about 1.7 s"))
      << plan.why;
  card.rates.measured = true;
  EXPECT_TRUE(mentions(plan_of(large, card).why, "by its measured rates"))
      << plan_of(large, card).why;
  // In fp64, in place, whatever the precision is that nobody has asked for; fp32 beside that.
  EXPECT_FALSE(plan.fp64);
  EXPECT_TRUE(plan.exact_inverse);
  EXPECT_TRUE(mentions(plan.why, "the device computes the inverse and keeps it in fp64"));
  PlanDevice enough = card;
  enough.memory = std::size_t{700} << 20;
  EXPECT_EQ(plan_of(large, enough).route, Route::inverse);
  Scene in_fp32 = large;
  in_fp32.solver.precision = sunder::Precision::fp32;
  EXPECT_EQ(plan_of(in_fp32, enough).route, Route::cg) << "482 MB while it is made, twice";
  EXPECT_FALSE(plan_of(in_fp32, card).exact_inverse);
  PlanDevice slow = card, narrow = card, small = card, none = card, single = card;
  slow.rates.flops = 5e10;
  narrow.rates.bytes = 1e10;
  small.memory = std::size_t{600} << 20;  // 321 MB in fp64, twice
  none.inverts_from = kNone;
  single.rates.flops = 0;
  for (const PlanDevice& device : {slow, narrow, small, none, single}) {
    EXPECT_EQ(plan_of(large, device).route, Route::cg);
  }
}

// What the backends begin with, for the cost of a frame.
TEST(Plan, GivesTheShapeOfAFrame) {
  Scene scene = board(20, 2);
  const Problem problem(scene);
  const Plan plan = make_plan(problem, test::all_needs(), host());
  const FrameShape shape = plan.shape(problem, test::all_needs());
  EXPECT_EQ(shape.kept, 630u);
  EXPECT_EQ(shape.unknowns, 2520u);
  EXPECT_EQ(shape.route, Route::condensed);
  EXPECT_TRUE(shape.damage);
  const FrameCost cost = frame_cost(shape, host().rates);
  EXPECT_GT(cost.fracture.ms, cost.quiet.ms);
  EXPECT_EQ(cost.quiet.bytes, 0) << "nothing is apart from the host";
}

}  // namespace
}  // namespace sunder::solver
