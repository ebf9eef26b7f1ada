// SPDX-License-Identifier: Apache-2.0
// The thread rules of sunder.h, to be run under the thread sanitizer as well.
#include <atomic>
#include <string>
#include <thread>

#include "api/c_scene.hpp"

namespace sunder::test {
namespace {

std::vector<double> tear() {
  const sunder_simulation simulation = board_simulation();
  for (int i = 0; i < 4; ++i) EXPECT_OK(sunder_simulation_step(simulation, nullptr));
  std::vector<double> u(150);
  EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  EXPECT_OK(sunder_simulation_destroy(simulation));
  return u;
}

TEST(CThreads, DifferentHandlesRunAtOnceAndAgree) {
  const std::vector<double> alone = tear();
  std::vector<std::vector<double>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results) threads.emplace_back([&result] { result = tear(); });
  for (auto& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, alone) << "bit for bit";
}

TEST(CThreads, OneHandleServesOneCallAtATime) {
  const sunder_scene scene = board_scene();
  EXPECT_OK(sunder_scene_set_steps(scene, 100000));
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  std::atomic<int> done{0}, busy{0}, other{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const sunder_status status = sunder_simulation_step(simulation, nullptr);
        (status == SUNDER_OK ? done : status == SUNDER_ERROR_BUSY ? busy : other)++;
        if (status == SUNDER_ERROR_BUSY) std::this_thread::yield();
      }
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(other, 0);
  EXPECT_EQ(done + busy, 200);
  sunder_step step{};
  step.struct_size = sizeof step;
  ASSERT_OK(sunder_simulation_step(simulation, &step));
  EXPECT_EQ(step.step, done) << "each successful call was one step";
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

// A callback that waits makes the moment certain: the handle is in use.
struct Gate {
  std::atomic<bool> inside{false}, open{false};
  static std::int32_t wait(void* user, const sunder_progress* p) {
    auto& gate = *static_cast<Gate*>(user);
    if (p->phase != SUNDER_PHASE_STEP) return 0;
    gate.inside = true;
    while (!gate.open) std::this_thread::yield();
    return 0;
  }
};

TEST(CThreads, AHandleInUseIsBusyButCanBeCancelled) {
  Gate gate;
  sunder_callbacks callbacks{};
  callbacks.struct_size = sizeof callbacks;
  callbacks.progress = Gate::wait;
  callbacks.progress_user = &gate;
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 4, -400);
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, &callbacks, &simulation));
  sunder_status stepped = SUNDER_OK;
  std::thread worker([&] { stepped = sunder_simulation_step(simulation, nullptr); });
  while (!gate.inside) std::this_thread::yield();
  std::vector<double> u(150);
  EXPECT_EQ(sunder_simulation_displacement(simulation, u.data(), u.size()), SUNDER_ERROR_BUSY);
  std::int32_t id = 0;
  const double place[3] = {0, 0, 0};
  EXPECT_EQ(sunder_simulation_grasp(simulation, &id, 1, 0, &id), SUNDER_ERROR_BUSY);
  EXPECT_EQ(sunder_simulation_pose(simulation, 1, place, nullptr), SUNDER_ERROR_BUSY);
  EXPECT_EQ(sunder_simulation_release(simulation, 1), SUNDER_ERROR_BUSY);
  EXPECT_EQ(sunder_simulation_push(simulation, &id, 1, place, &id), SUNDER_ERROR_BUSY);
  EXPECT_EQ(sunder_simulation_destroy(simulation), SUNDER_ERROR_BUSY);
  EXPECT_OK(sunder_simulation_cancel(simulation));
  gate.open = true;
  worker.join();
  EXPECT_EQ(stepped, SUNDER_ERROR_CANCELLED);
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
}

TEST(CThreads, ErrorsBelongToTheirThread) {
  EXPECT_EQ(sunder_scene_destroy(nullptr), SUNDER_ERROR_HANDLE);
  std::string before, after;
  std::thread([&] {
    before = sunder_last_error();
    static_cast<void>(sunder_scene_create(nullptr));
    after = sunder_last_error();
  }).join();
  EXPECT_EQ(before, "");
  EXPECT_EQ(after, "scene is null");
  EXPECT_NE(std::string(sunder_last_error()), after);
}

}  // namespace
}  // namespace sunder::test
