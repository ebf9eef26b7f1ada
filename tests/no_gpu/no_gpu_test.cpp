// SPDX-License-Identifier: Apache-2.0
// A build without the Vulkan backend (SUNDER_GPU=OFF): it says so, and does all else.
#include <gtest/gtest.h>

#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

std::shared_ptr<const Problem> small_board(const std::string& backend) {
  Scene scene;
  scene.mesh = structured_board({2, 2, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  scene.solver.backend = backend;
  return std::make_shared<const Problem>(std::move(scene));
}

TEST(NoGpu, TheListsHaveTheCpuAlone) {
  EXPECT_EQ(backend_names(), std::vector<std::string>{"cpu"});
  const auto list = devices();
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list.front().backend, "cpu");
  EXPECT_TRUE(list.front().chosen);
}

TEST(NoGpu, VulkanByNameSaysWhatIsMissing) {
  const auto problem = small_board("vulkan");
  try {
    static_cast<void>(create_backend(problem, needs_of(*problem)));
    FAIL() << "no error";
  } catch (const DeviceError& error) {
    EXPECT_STREQ(error.what(),
                 "this build leaves out the backend vulkan (SUNDER_GPU=OFF); it has cpu");
    EXPECT_EQ(error.exit_code(), 4);
  }
}

TEST(NoGpu, AutoTakesTheCpuWithoutAWarning) {
  const auto problem = small_board("auto");
  const auto created = create_backend(problem, needs_of(*problem));
  EXPECT_EQ(created.backend->info().backend, "cpu");
  EXPECT_TRUE(created.warnings.empty());
}

}  // namespace
}  // namespace sunder::test
