// SPDX-License-Identifier: Apache-2.0
// Simulations that share what is made of one body are those that share nothing.
#include <thread>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

/// All steps: displacements, and what was destroyed.
std::pair<std::vector<double>, std::vector<std::uint8_t>> end_of(sunder_simulation simulation) {
  for (int i = 0; i < 4; ++i) EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  std::vector<double> u(150);
  std::vector<std::uint8_t> destroyed(96);
  EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  EXPECT_OK(sunder_simulation_destroyed(simulation, destroyed.data(), destroyed.size()));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  return {u, destroyed};
}

TEST(CBodies, SharedGiveTheSameBitsFromManyThreads) {
  const auto alone = end_of(board_simulation());
  sunder_bodies bodies = nullptr;
  ASSERT_OK(sunder_bodies_create(1, &bodies));
  std::vector<std::thread> threads;
  std::vector<std::pair<std::vector<double>, std::vector<std::uint8_t>>> ends(4);
  for (auto& end : ends) {
    threads.emplace_back([&end, bodies] {
      const sunder_scene scene = board_scene();
      sunder_simulation simulation = nullptr;
      EXPECT_OK(sunder_simulation_create_of(scene, bodies, nullptr, &simulation));
      EXPECT_OK(sunder_scene_destroy(scene));
      end = end_of(simulation);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& end : ends) EXPECT_EQ(end, alone);
  EXPECT_OK(sunder_bodies_destroy(bodies));
  EXPECT_EQ(sunder_bodies_destroy(bodies), SUNDER_ERROR_HANDLE);
}

TEST(CBodies, SimulationsOutliveThem) {
  sunder_bodies bodies = nullptr;
  ASSERT_OK(sunder_bodies_create(1, &bodies));
  const sunder_scene scene = board_scene();
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create_of(scene, bodies, nullptr, &simulation));
  ASSERT_OK(sunder_scene_destroy(scene));
  ASSERT_OK(sunder_bodies_destroy(bodies));
  EXPECT_EQ(end_of(simulation), end_of(board_simulation()));
}

}  // namespace
}  // namespace sunder::test
