// SPDX-License-Identifier: Apache-2.0
// Compiled kernels in a host's hands, through both interfaces.
#include <cstdlib>
#include <string>

#include "api/c_scene.hpp"
#include "api/vulkan_host.hpp"
#include "c/simulation.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

class CPipelineCache : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) GTEST_SKIP() << "no Vulkan device is expected";
    scene = board_scene(SUNDER_BACKEND_VULKAN);
  }
  void TearDown() override {
    if (scene) {
      EXPECT_OK(sunder_scene_destroy(scene));
    }
  }
  /// Runs a step with bytes that were kept; what is to be kept of it, and its warnings.
  Bytes run(const Bytes& kept) {
    EXPECT_OK(sunder_vulkan_set_pipeline_cache(scene, kept.data(), kept.size()));
    sunder_simulation simulation = nullptr;
    EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    EXPECT_OK(sunder_simulation_step(simulation, nullptr));
    warnings = c::find<c::SimulationObject>(simulation, "simulation")->warnings();
    Bytes bytes = read(simulation);
    EXPECT_OK(sunder_simulation_destroy(simulation));
    return bytes;
  }
  static Bytes read(sunder_simulation simulation) {
    std::size_t length = 0;
    EXPECT_OK(sunder_vulkan_pipeline_cache(simulation, nullptr, 0, &length));
    Bytes bytes(length);
    EXPECT_OK(sunder_vulkan_pipeline_cache(simulation, bytes.data(), bytes.size(), &length));
    EXPECT_EQ(length, bytes.size());
    return bytes;
  }
  [[nodiscard]] std::string ignored() const {
    for (const std::string& text : warnings) {
      if (text.find("pipeline cache") != std::string::npos) return text;
    }
    return {};
  }

  sunder_scene scene = nullptr;
  std::vector<std::string> warnings;
};

TEST_F(CPipelineCache, GoesFromOneRunToTheNext) {
  const Bytes kept = run({});
  ASSERT_FALSE(kept.empty());
  EXPECT_EQ(ignored(), "");
  EXPECT_GE(run(kept).size(), kept.size());
  EXPECT_EQ(ignored(), "");
}

TEST_F(CPipelineCache, BytesThatDoNotFitAreIgnoredAndSaid) {
  Bytes kept = run({});
  kept.resize(kept.size() - 1);
  EXPECT_FALSE(run(kept).empty());
  EXPECT_EQ(ignored(), "the pipeline cache that was handed in is ignored: it is cut");
  run(Bytes(1000, 1));
  EXPECT_EQ(ignored(),
            "the pipeline cache that was handed in is ignored: it is none that this library has "
            "given out");
}

TEST_F(CPipelineCache, IsReadIntoRoomThatSuffices) {
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  const Bytes all = read(simulation);
  Bytes small(all.size() - 1, 42);
  std::size_t length = 0;
  EXPECT_EQ(sunder_vulkan_pipeline_cache(simulation, small.data(), small.size(), &length),
            SUNDER_ERROR_SIZE);
  EXPECT_EQ(std::string(sunder_last_error()), "capacity is " + std::to_string(small.size()) +
                                                  " bytes; " + std::to_string(all.size()) +
                                                  " are needed");
  EXPECT_EQ(length, all.size());
  EXPECT_EQ(small, Bytes(all.size() - 1, 42));
  EXPECT_EQ(sunder_vulkan_pipeline_cache(simulation, nullptr, 8, &length), SUNDER_ERROR_NULL);
  EXPECT_EQ(sunder_vulkan_pipeline_cache(simulation, nullptr, 0, nullptr), SUNDER_ERROR_NULL);
  EXPECT_EQ(sunder_vulkan_set_pipeline_cache(scene, nullptr, 1), SUNDER_ERROR_NULL);
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// On a host's own device too: its driver's header is that of ours.
TEST_F(CPipelineCache, OfOurDeviceFitsTheHosts) {
  const Bytes kept = run({});
  EXPECT_OK(sunder_vulkan_set_pipeline_cache(scene, kept.data(), kept.size()));
  VulkanHost host;
  const auto lent = host.lend();
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_vulkan_create(scene, &lent, nullptr, &simulation));
  EXPECT_GE(read(simulation).size(), kept.size());
  warnings = c::find<c::SimulationObject>(simulation, "simulation")->warnings();
  EXPECT_EQ(ignored(), "");
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// A simulation on the processor gives back what it was handed.
TEST_F(CPipelineCache, OnTheCpuIsAsItWasHandedIn) {
  EXPECT_OK(sunder_scene_destroy(scene));
  scene = board_scene(SUNDER_BACKEND_CPU);
  const Bytes any = {1, 2, 3};
  EXPECT_EQ(run(any), any);
  EXPECT_EQ(ignored(), "");
}

TEST_F(CPipelineCache, InCppIsAnObjectThatABackendTakes) {
  Scene of;
  of.mesh = structured_board({2, 2, 1});
  of.materials["board"] = {5, 0.4, 2.0};
  of.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  of.solver.backend = "vulkan";
  const auto problem = std::make_shared<const Problem>(of);
  const auto cache = std::make_shared<PipelineCache>();
  { const auto created = create_backend(problem, needs_of(*problem), cache); }
  std::vector<std::byte> kept = cache->bytes();
  ASSERT_FALSE(kept.empty());
  kept.back() ^= std::byte{1};
  const auto created =
      create_backend(problem, needs_of(*problem), std::make_shared<PipelineCache>(kept));
  ASSERT_EQ(created.warnings.size(), 1u);
  EXPECT_EQ(created.warnings.front(),
            "the pipeline cache that was handed in is ignored: its bytes have changed");
}

}  // namespace
}  // namespace sunder::test
