// SPDX-License-Identifier: Apache-2.0
// The surface in buffers of a host's own: what sunder_simulation_surface and its like tell, written
// by the device, after all that changes a body; nothing beside it, nothing that has not changed,
// and refusals by name.
#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "api/c_scene.hpp"
#include "api/lent_buffers.hpp"
#include "api/vulkan_host.hpp"
#include "gpu/run_again.hpp"

namespace sunder::test {
namespace {

constexpr double kRounding = 0x1p-23;  // of one number in fp32, and one more for another order

// Of 8 steps the fourth tears the intact board.
constexpr double kPull = -12;  // N
constexpr double kYield = 2;   // MPa, board_scene()'s

struct Environment {
  explicit Environment(const char* probe) { setenv("SUNDER_VULKAN_PROBE", probe, 1); }
  ~Environment() { unsetenv("SUNDER_VULKAN_PROBE"); }
};

/// Vertices inside the board, on its faces and beyond them.
std::vector<double> fine_mesh() {
  std::vector<double> at;
  for (int i = 0; i < 40; ++i) at.insert(at.end(), {0.26 * i, 10.1 - 0.25 * i, 0.031 * i});
  return at;
}

class CVulkanSurface : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) {
      GTEST_SKIP() << "no Vulkan device is expected";
    }
    if (*GetParam()) probe.emplace(GetParam());
    host.emplace();
  }
  void TearDown() override {
    if (!host) return;
    if (simulation) {
      EXPECT_OK(sunder_simulation_destroy(simulation));
    }
    buffers.reset();
    EXPECT_FALSE(VulkanHost::calls.submitted_unlocked);
    EXPECT_EQ(VulkanHost::calls.device_waits, 0);
  }
  /// On the host's device, or on the CPU with the host's device for drawing alone.
  void create(bool shared, const std::function<void(sunder_scene)>& change = {},
              std::int32_t law = SUNDER_LAW_LINEAR) {
    const sunder_scene scene =
        board_scene(shared ? SUNDER_BACKEND_VULKAN : SUNDER_BACKEND_CPU, 4, kPull, law);
    EXPECT_OK(sunder_scene_set_steps(scene, 8));
    if (change) change(scene);
    on_device = shared;
    const sunder_vulkan_host lent = host->lend();
    if (shared) {
      ASSERT_OK(sunder_vulkan_create(scene, &lent, nullptr, &simulation));
    } else {
      ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
      ASSERT_OK(sunder_simulation_keep_history(simulation, 100));
    }
    EXPECT_OK(sunder_scene_destroy(scene));
    const auto fine = fine_mesh();
    ASSERT_OK(sunder_simulation_set_skin(simulation, fine.data(), fine.size()));
    vertices = fine.size() / 3;
  }
  void lend(std::uint64_t triangles = 400, std::uint64_t nodes = 200) {
    auto more = std::make_unique<LentBuffers>(*host, nodes, triangles, vertices);
    const sunder_vulkan_host device = host->lend();
    ASSERT_OK(
        sunder_vulkan_lend_surface(simulation, on_device ? nullptr : &device, &more->surface));
    buffers = std::move(more);
  }
  void step() { ASSERT_OK(sunder_simulation_step(simulation, nullptr)); }
  sunder_surface record() {
    sunder_surface surface = SUNDER_SURFACE_INIT;
    host->run([&](VkCommandBuffer commands) {
      EXPECT_OK(sunder_vulkan_record_surface(simulation, commands, &surface));
    });
    return surface;
  }
  /// How much larger than the sum of a node's triangles are the products that it is made of: what a
  /// rounding of these costs the unit normal.
  [[nodiscard]] static std::vector<double> amplification(std::span<const float> places,
                                                         std::span<const std::int32_t> triangles) {
    std::vector<Vec3> sum(places.size() / 3, Vec3::Zero());
    std::vector<double> products(sum.size(), 0.0);
    const auto at = [&](std::int32_t n) {
      return Eigen::Map<const Eigen::Vector3f>(places.data() + 3 * n).cast<double>().eval();
    };
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      const Vec3 a = at(triangles[t + 1]) - at(triangles[t]);
      const Vec3 b = at(triangles[t + 2]) - at(triangles[t]);
      for (std::size_t i = 0; i < 3; ++i) {
        const auto n = static_cast<std::size_t>(triangles[t + i]);
        sum[n] += a.cross(b);
        products[n] += a.norm() * b.norm();
      }
    }
    for (std::size_t n = 0; n < sum.size(); ++n) {
      products[n] = sum[n].norm() > 0 ? products[n] / sum[n].norm() : 0;
    }
    return products;
  }

  struct Deformed {
    double strain = 0, displacement = 0;  // largest principal value by magnitude; largest
    double gradient = 0;                  // of displacement, Frobenius: what a rounding is of
  };
  /// Of every element, from what is told of the body.
  [[nodiscard]] std::vector<Deformed> deformations() const {
    sunder_body body = SUNDER_BODY_INIT;
    EXPECT_OK(sunder_simulation_body(simulation, &body));
    const auto nodes = static_cast<std::size_t>(body.node_count);
    const auto tets = static_cast<std::size_t>(body.tet_count);
    std::vector<std::int32_t> corners(4 * tets), parents(nodes);
    std::vector<double> u(3 * nodes);
    EXPECT_OK(sunder_simulation_body_corners(simulation, corners.data(), corners.size()));
    EXPECT_OK(sunder_simulation_body_parents(simulation, parents.data(), parents.size()));
    EXPECT_OK(sunder_simulation_body_displacement(simulation, u.data(), u.size()));
    const std::vector<double> rest = board_arrays().nodes;
    std::vector<Deformed> all(tets);
    for (std::size_t e = 0; e < tets; ++e) {
      Mat3 x, moved;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto node = static_cast<std::size_t>(corners[4 * e + i]);
        const auto parent = static_cast<std::size_t>(parents[node]);
        const Vec3 at(rest.data() + 3 * parent), by(u.data() + 3 * node);
        all[e].displacement = std::max(all[e].displacement, by.norm());
        if (i == 0) {
          x.colwise() = -at;
          moved.colwise() = -by;
        } else {
          x.col(static_cast<Eigen::Index>(i) - 1) += at;
          moved.col(static_cast<Eigen::Index>(i) - 1) += by;
        }
      }
      const Mat3 gradient = moved * x.inverse(), f = gradient + Mat3::Identity();
      const Vec3 strain =
          finite ? Vec3(Eigen::JacobiSVD<Mat3>(f).singularValues().array() - 1)
                 : Vec3(Eigen::SelfAdjointEigenSolver<Mat3>((gradient + gradient.transpose()) / 2)
                            .eigenvalues());
      all[e].strain = strain.cwiseAbs().maxCoeff();
      all[e].gradient = gradient.norm();
    }
    return all;
  }
  /// What triangles are coloured by is what is told of their elements, within a rounding of the
  /// largest stress, or of a number where it is computed from displacement and place.
  void expect_values(std::size_t count, std::span<const std::int32_t> facts, double unit,
                     double ulps) const {
    const auto found = buffers->values(count);
    const auto shape = deformations();
    std::vector<double> shear(shape.size()), ratio(shape.size()), stress(6 * shape.size());
    EXPECT_OK(sunder_simulation_max_shear(simulation, shear.data(), shear.size()));
    EXPECT_OK(sunder_simulation_yield_ratio(simulation, ratio.data(), ratio.size()));
    EXPECT_OK(sunder_simulation_stress(simulation, stress.data(), stress.size()));
    for (std::size_t t = 0; t < count; ++t) {
      const auto e = static_cast<std::size_t>(facts[3 * t]);
      const double most =
          Eigen::Map<const Eigen::Matrix<double, 6, 1>>(stress.data() + 6 * e).norm();
      EXPECT_NEAR(found[4 * t], shear[e], 8 * kRounding * most) << t;
      EXPECT_NEAR(found[4 * t + 1], ratio[e], 8 * kRounding * most / kYield) << t;
      // Strain is rounded to fp32 once and the gradient in `unit`, whose squares are in U - I.
      const Deformed& d = shape[e];
      const double strain = 16 * kRounding * d.strain + 16 * unit * d.gradient +
                            (finite ? 8 * kRounding * (1 + d.gradient * d.gradient) : 0);
      EXPECT_NEAR(found[4 * t + 2], d.strain, strain) << t;
      EXPECT_NEAR(found[4 * t + 3], d.displacement, 2 * ulps * kRounding * d.displacement) << t;
    }
  }

  /// All of the buffers is what the functions that hand it out on the host say: places as they are
  /// rounded, normals within what roundings of `unit` cost them.
  void expect_shown(double unit = 0x1p-52, double ulps = 1) {
    const sunder_surface surface = record();
    const auto nodes = static_cast<std::size_t>(surface.node_count);
    const auto count = static_cast<std::size_t>(surface.triangle_count);
    std::vector<float> places(3 * nodes), normals(3 * nodes), skin(3 * vertices);
    EXPECT_OK(
        sunder_simulation_surface_points(simulation, places.data(), normals.data(), places.size()));
    const auto shown = buffers->places(nodes), outward = buffers->normals(nodes);
    const auto triangles = buffers->triangles(count), facts = buffers->facts(count);
    const auto costs = amplification(places, triangles);
    for (std::size_t i = 0; i < places.size(); ++i) {
      EXPECT_NEAR(shown[i], places[i], ulps * kRounding * std::abs(places[i])) << i;
      EXPECT_NEAR(outward[i], normals[i], kRounding + 8 * unit * costs[i / 3]) << i;
    }
    std::vector<sunder_triangle> all(count + 400);
    std::size_t there = 0;
    EXPECT_OK(sunder_simulation_surface_changes(simulation, 0, all.data(), all.size(), &there));
    ASSERT_EQ(there, count);
    for (std::size_t t = 0; t < count; ++t) {
      const std::int32_t told[] = {all[t].element, all[t].piece, all[t].opened};
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(triangles[3 * t + i], all[t].nodes[i]) << t;
        EXPECT_EQ(facts[3 * t + i], told[i]) << t;
      }
    }
    expect_values(count, facts, unit, ulps);
    std::vector<std::uint8_t> lives(vertices);
    EXPECT_OK(sunder_simulation_skin(simulation, skin.data(), skin.size(), lives.data()));
    const auto carried = buffers->skin(vertices);
    for (std::size_t i = 0; i < skin.size(); ++i) {
      EXPECT_NEAR(carried[i], skin[i], ulps * kRounding * std::abs(skin[i])) << i;
    }
    const auto living = buffers->lives(vertices);
    EXPECT_TRUE(std::ranges::equal(living, lives, {}, {}, [](std::uint8_t l) { return l; }));
    buffers->expect_nothing_beside();
  }
  /// Five cells at the left edge go, and the one between them comes loose.
  void cut_a_cell_off() {
    std::vector<std::uint8_t> gone(96);
    EXPECT_OK(sunder_simulation_destroyed(simulation, gone.data(), gone.size()));
    std::vector<std::int32_t> elements;
    for (std::int32_t cell : {4, 5, 9, 12, 13}) {
      for (std::int32_t e = 6 * cell; e < 6 * cell + 6; ++e) {
        if (!gone[static_cast<std::size_t>(e)]) elements.push_back(e);
      }
    }
    ASSERT_OK(sunder_simulation_remove(simulation, elements.data(), elements.size()));
  }
  [[nodiscard]] bool has_pieces() const {
    const auto facts = buffers->facts(static_cast<std::size_t>(state().triangle_count));
    for (std::size_t t = 0; 3 * t < facts.size(); ++t) {
      if (facts[3 * t + 1] >= 0) return true;
    }
    return false;
  }
  [[nodiscard]] sunder_surface state() const {
    sunder_surface surface = SUNDER_SURFACE_INIT;
    EXPECT_OK(sunder_simulation_surface(simulation, &surface));
    return surface;
  }
  void refused(sunder_status status, const char* says, sunder_status is) const {
    EXPECT_EQ(is, status);
    EXPECT_NE(std::string(sunder_last_error()).find(says), std::string::npos)
        << sunder_last_error();
  }

  std::optional<Environment> probe;
  std::optional<VulkanHost> host;
  std::unique_ptr<LentBuffers> buffers;
  sunder_simulation simulation = nullptr;
  bool on_device = false, finite = false;
  std::size_t vertices = 0;
};

TEST_P(CVulkanSurface, FollowsRupturesAndPiecesOnTheHostsDevice) {
  create(true);
  lend();
  step();
  expect_shown();
  cut_a_cell_off();
  expect_shown();
  EXPECT_TRUE(has_pieces());
  const std::int32_t cut = state().triangle_count;
  for (int i = 0; i < 5; ++i) {
    step();
    expect_shown();
  }
  EXPECT_NE(state().triangle_count, cut) << "nothing broke";
}

TEST_P(CVulkanSurface, FollowsUndoOfASimulationElsewhere) {
  create(false);
  lend();
  expect_shown();  // before the first step
  step();
  cut_a_cell_off();
  expect_shown();
  EXPECT_TRUE(has_pieces());
  for (int i = 0; i < 5; ++i) {
    step();
    expect_shown();
  }
  const std::int32_t torn = state().triangle_count;
  std::int32_t undos = 0;
  ASSERT_OK(sunder_simulation_history(simulation, &undos, nullptr));
  ASSERT_GT(undos, 1);
  for (std::int32_t i = 0; i < undos; ++i) {
    ASSERT_OK(sunder_simulation_undo(simulation, 1, nullptr, nullptr));
    expect_shown();
  }
  EXPECT_FALSE(has_pieces());
  EXPECT_NE(state().triangle_count, torn);
  ASSERT_OK(sunder_simulation_redo(simulation, undos, nullptr));
  expect_shown();
  EXPECT_EQ(state().triangle_count, torn);
}

TEST_P(CVulkanSurface, FollowsCracksThatSplitAndTheirUndo) {
  create(false, [](sunder_scene scene) {
    auto fracture = model(SUNDER_FRACTURE_B);
    fracture.crack = SUNDER_CRACK_SPLIT;
    fracture.sif = SUNDER_SIF_FIELD;
    fracture.alpha = 1e-8;
    EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
  });
  lend();
  const std::int32_t whole = state().node_count;
  for (int i = 0; i < 5; ++i) {
    step();
    expect_shown();
  }
  const std::int32_t parted = state().node_count;
  EXPECT_GT(parted, whole);
  ASSERT_OK(sunder_simulation_undo(simulation, 1, nullptr, nullptr));
  expect_shown();
  EXPECT_LT(state().node_count, parted);
  ASSERT_OK(sunder_simulation_redo(simulation, 1, nullptr));
  EXPECT_EQ(state().node_count, parted);
  expect_shown();
}

TEST_P(CVulkanSurface, ColoursALawOfFiniteDeformation) {
  create(
      false,
      [](sunder_scene scene) {
        const auto fracture = model(SUNDER_FRACTURE_A);
        EXPECT_OK(sunder_scene_set_fracture(scene, &fracture));
      },
      SUNDER_LAW_NEO_HOOKEAN);
  finite = true;
  lend();
  expect_shown();
  for (int i = 0; i < 3; ++i) {
    step();
    expect_shown();
  }
}

// Numbers of two floats each: some 48 bits go into a sum, and its parts are rounded in fp32.
TEST_P(CVulkanSurface, DoesWithoutFloat64) {
  host.reset();
  VulkanHost::Options few;
  few.float64 = false;
  host.emplace(few);
  create(true);
  lend();
  for (int i = 0; i < 5; ++i) {
    step();
    expect_shown(0x1p-24, 2);
  }
}

TEST_P(CVulkanSurface, WritesOnlyTheTrianglesThatHaveChanged) {
  create(true, [](sunder_scene scene) {
    const auto none = model(SUNDER_FRACTURE_NONE);
    EXPECT_OK(sunder_scene_set_fracture(scene, &none));
    EXPECT_OK(sunder_scene_set_live(scene, 1));
  });
  lend();
  step();
  const sunder_surface first = record();
  EXPECT_EQ(buffers->written().size(), static_cast<std::size_t>(first.triangle_count));
  buffers->forget();
  step();
  record();
  EXPECT_TRUE(buffers->written().empty());
  const std::int32_t element = 40;
  ASSERT_OK(sunder_simulation_remove(simulation, &element, 1));
  const sunder_surface then = record();
  std::vector<sunder_triangle> changes(400);
  std::size_t count = 0;
  ASSERT_OK(sunder_simulation_surface_changes(simulation, first.version, changes.data(),
                                              changes.size(), &count));
  ASSERT_GT(count, 0u);
  ASSERT_LT(count, static_cast<std::size_t>(then.triangle_count));
  const auto written = buffers->written();
  ASSERT_EQ(written.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(written[i], static_cast<std::size_t>(changes[i].place));
  }
}

TEST_P(CVulkanSurface, AddsNoSubmitCopyOrReadToTheFrame) {
  create(true);
  lend();
  step();
  record();
  step();
  const Calls before = VulkanHost::calls;
  record();
  EXPECT_EQ(VulkanHost::calls.submits, before.submits);
  EXPECT_EQ(VulkanHost::calls.copies, before.copies);
  EXPECT_LE(VulkanHost::calls.dispatches, before.dispatches + 4);
}

// A host of the version before has no values at the end of its struct.
TEST_P(CVulkanSurface, TakesTheStructOfTheVersionBefore) {
  create(true);
  lend();
  step();
  sunder_vulkan_surface before = buffers->surface;
  before.struct_size = offsetof(sunder_vulkan_surface, values);
  ASSERT_OK(sunder_vulkan_lend_surface(simulation, nullptr, &before));
  const sunder_surface surface = record();
  const auto count = static_cast<std::size_t>(surface.triangle_count);
  EXPECT_EQ(buffers->written().size(), count);
  for (const float value : buffers->values(count)) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(value), 0xa5a5a5a5U);
  }
}

TEST_P(CVulkanSurface, SaysWhatHasBecomeTooSmallAndTakesLargerOnes) {
  create(true);
  const auto intact = static_cast<std::uint64_t>(state().triangle_count);
  lend(intact, 50);
  step();
  cut_a_cell_off();
  const auto now = static_cast<std::uint64_t>(state().triangle_count);
  ASSERT_NE(now, intact);
  lend(std::min(now, intact) - 1, 50);
  sunder_surface told = SUNDER_SURFACE_INIT;
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_SIZE,
            ("triangles has " + std::to_string(12 * (std::min(now, intact) - 1)) +
             " bytes; it must have " + std::to_string(12 * now))
                .c_str(),
            sunder_vulkan_record_surface(simulation, commands, &told));
  });
  EXPECT_EQ(told.triangle_count, static_cast<std::int32_t>(now));
  lend(now, 49);
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_SIZE, "places has 1568 bytes; it must have 1580",
            sunder_vulkan_record_surface(simulation, commands, nullptr));
  });
  EXPECT_TRUE(buffers->written().empty());
  lend(now, 50);
  expect_shown();
}

TEST_P(CVulkanSurface, RefusesByName) {
  create(true);
  const auto device = host->lend();
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_ORDER, "no buffers are lent",
            sunder_vulkan_record_surface(simulation, commands, nullptr));
  });
  LentBuffers some(*host, 200, 400, vertices);
  const auto lend_changed = [&](void (*change)(sunder_vulkan_surface&)) {
    sunder_vulkan_surface surface = some.surface;
    change(surface);
    return sunder_vulkan_lend_surface(simulation, nullptr, &surface);
  };
  refused(SUNDER_ERROR_VALUE, "places has usage = 128, without VK_BUFFER_USAGE_STORAGE_BUFFER_BIT",
          lend_changed([](auto& s) { s.places.usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT; }));
  refused(SUNDER_ERROR_VALUE, "normals has offset = 54",
          lend_changed([](auto& s) { s.normals.offset += 2; }));
  refused(SUNDER_ERROR_VALUE, "triangles has stride = 8",
          lend_changed([](auto& s) { s.triangles.stride = 8; }));
  refused(SUNDER_ERROR_VALUE, "facts has stride = 14",
          lend_changed([](auto& s) { s.facts.stride = 14; }));
  refused(SUNDER_ERROR_VALUE, "values has stride = 12; it must be a multiple of 4, and 16 or more",
          lend_changed([](auto& s) { s.values.stride = 12; }));
  refused(SUNDER_ERROR_STRUCT_SIZE, "surface", lend_changed([](auto& s) { s.struct_size = 3; }));
  refused(SUNDER_ERROR_ORDER, "the simulation is on a host's device",
          sunder_vulkan_lend_surface(simulation, &device, &some.surface));
  ASSERT_OK(sunder_vulkan_lend_surface(simulation, nullptr, &some.surface));
  refused(SUNDER_ERROR_NULL, "command buffer",
          sunder_vulkan_record_surface(simulation, nullptr, nullptr));
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_ORDER, "before a step",
            sunder_vulkan_record_surface(simulation, commands, nullptr));
    sunder_surface unset = SUNDER_SURFACE_INIT;
    unset.struct_size = 1;
    refused(SUNDER_ERROR_STRUCT_SIZE, "surface",
            sunder_vulkan_record_surface(simulation, commands, &unset));
  });
  step();
  const auto fine = fine_mesh();
  ASSERT_OK(sunder_simulation_set_skin(simulation, fine.data(), 30));
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_ORDER, "the skin was given anew",
            sunder_vulkan_record_surface(simulation, commands, nullptr));
  });
  ASSERT_OK(sunder_vulkan_lend_surface(simulation, nullptr, nullptr));  // takes them back
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_ORDER, "no buffers are lent",
            sunder_vulkan_record_surface(simulation, commands, nullptr));
  });
  const sunder_simulation gone = simulation;
  ASSERT_OK(sunder_simulation_destroy(simulation));
  simulation = nullptr;
  refused(SUNDER_ERROR_HANDLE, "destroyed",
          sunder_vulkan_lend_surface(gone, nullptr, &some.surface));
  host->run([&](VkCommandBuffer commands) {
    refused(SUNDER_ERROR_HANDLE, "destroyed",
            sunder_vulkan_record_surface(gone, commands, nullptr));
  });
}

TEST_P(CVulkanSurface, AsksASimulationElsewhereForTheDevice) {
  create(false);
  LentBuffers some(*host, 200, 400, vertices);
  refused(SUNDER_ERROR_ORDER, "not on a host's device (backend cpu): host must name",
          sunder_vulkan_lend_surface(simulation, nullptr, &some.surface));
  auto device = host->lend();
  device.queue_family = 77;
  refused(SUNDER_ERROR_VALUE, "queue_family 77",
          sunder_vulkan_lend_surface(simulation, &device, &some.surface));
  device = host->lend();
  device.device = nullptr;
  refused(SUNDER_ERROR_NULL, "host: device is null",
          sunder_vulkan_lend_surface(simulation, &device, &some.surface));
  const sunder_simulation bare = board_simulation();
  device = host->lend();
  refused(SUNDER_ERROR_ORDER, "no skin", sunder_vulkan_lend_surface(bare, &device, &some.surface));
  EXPECT_OK(sunder_simulation_destroy(bare));
}

INSTANTIATE_TEST_SUITE_P(Memory, CVulkanSurface, testing::Values("", "as_gpu"),
                         [](const auto& info) {
                           return std::string(*info.param ? info.param : "mapped");
                         });

// Its four kernels wait for each other where barriers stand, which are set by hand.
TEST(CVulkanSurfaceBackwards, WhatStandsBetweenBarriersRunsInAnyOrder) {
  if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
  const auto [output, code] =
      run_again("SUNDER_TEST_LAYER=backwards", "Memory/CVulkanSurface.Follows*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("ran in reverse order"), std::string::npos) << output;
}

}  // namespace
}  // namespace sunder::test
