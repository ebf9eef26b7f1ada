// SPDX-License-Identifier: Apache-2.0
// The thread rules of sunder.h, to be run under the thread sanitizer as well.
#include <atomic>
#include <chrono>
#include <cmath>
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

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

// Whatever is in work: a long step, its Newton iterations, a base made beside the frames.
TEST(CThreads, DestroyReturnsWhileAStepGoesOn) {
  for (const bool finite : {false, true}) {
    const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 24, finite ? -4 : -400);
    if (finite) {
      // By a law of its own: a step is many iterations and some factors.
      sunder_material tissue = SUNDER_MATERIAL_INIT;
      tissue.young = 5;
      tissue.poisson = 0.4;
      tissue.yield = 1e6;
      tissue.law = SUNDER_LAW_NEO_HOOKEAN;
      std::int32_t index = 0;
      EXPECT_OK(sunder_scene_add_material(scene, &tissue, &index));
      const Arrays a = board_arrays(24);
      const std::vector<std::int32_t> of(a.tets.size() / 4, index);
      EXPECT_OK(sunder_scene_set_mesh(scene, a.nodes.data(), a.nodes.size(), a.tets.data(),
                                      a.tets.size(), of.data(), of.size()));
    }
    EXPECT_OK(sunder_scene_set_steps(scene, 1 << 30));
    sunder_simulation simulation = nullptr;
    ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
    std::atomic<int> steps{0};
    sunder_status last = SUNDER_OK;
    std::thread worker([&] {
      while (last == SUNDER_OK) {
        last = sunder_simulation_step(simulation, nullptr);
        ++steps;
      }
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    const auto start = std::chrono::steady_clock::now();
    EXPECT_OK(sunder_simulation_destroy(simulation));
    const double took = ms_since(start);
    EXPECT_EQ(sunder_simulation_destroy(simulation), SUNDER_ERROR_HANDLE);
    worker.join();
    EXPECT_TRUE(last == SUNDER_ERROR_HANDLE || last == SUNDER_ERROR_CANCELLED) << last;
#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
    EXPECT_LE(took, 50) << "after " << steps << " steps";
#else
    static_cast<void>(took);
#endif
  }
}

// What callbacks use may go as soon as destroy has returned.
TEST(CThreads, NoCallbackRunsAfterDestroy) {
  struct Host {
    std::atomic<bool> destroyed{false}, late{false}, called{false};
    static std::int32_t progress(void* user, const sunder_progress*) {
      auto& host = *static_cast<Host*>(user);
      host.late = host.late || host.destroyed;
      host.called = true;
      return 0;
    }
  };
  for (int i = 0; i < 10; ++i) {
    Host host;
    sunder_callbacks callbacks = SUNDER_CALLBACKS_INIT;
    callbacks.progress = Host::progress;
    callbacks.progress_user = &host;
    const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 8, -4000);
    sunder_simulation simulation = nullptr;
    ASSERT_OK(sunder_simulation_create(scene, &callbacks, &simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
    host.called = false;
    std::thread worker([&] { static_cast<void>(sunder_simulation_step(simulation, nullptr)); });
    while (!host.called) std::this_thread::yield();
    sunder_status ended = SUNDER_ERROR_BUSY;
    while (ended == SUNDER_ERROR_BUSY) ended = sunder_simulation_destroy(simulation);
    host.destroyed = true;
    EXPECT_OK(ended);
    worker.join();
    EXPECT_FALSE(host.late);
  }
}

TEST(CThreads, FramesAreReadWhileTheNextOneRuns) {
  const sunder_scene scene = board_scene();
  EXPECT_OK(sunder_scene_set_steps(scene, 200));
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  sunder_frames frames = nullptr;
  ASSERT_OK(sunder_frames_create(simulation, SUNDER_FRAME_DISPLACEMENT | SUNDER_FRAME_DESTROYED,
                                 nullptr, 0, &frames));
  std::vector<std::vector<double>> of_step(200, std::vector<double>(150));
  std::vector<double> seen(150);
  std::vector<std::pair<std::int32_t, std::vector<double>>> read;
  std::atomic<bool> done{false};
  sunder_status worst = SUNDER_OK;
  std::thread picture([&] {
    while (!done) {
      sunder_frame frame = SUNDER_FRAME_INIT;
      sunder_status status = sunder_frames_take(frames, &frame);
      if (status == SUNDER_OK) {
        status = sunder_frames_displacement(frames, seen.data(), seen.size());
      }
      if (status != SUNDER_OK) worst = status;
      if (read.empty() || read.back().first != frame.step) read.emplace_back(frame.step, seen);
      std::this_thread::yield();
    }
  });
  for (auto& u : of_step) {
    ASSERT_OK(sunder_simulation_step(simulation, nullptr));
    ASSERT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  }
  done = true;
  picture.join();
  EXPECT_EQ(worst, SUNDER_OK);
  EXPECT_GE(read.size(), 2u);
  for (const auto& [step, u] : read) {
    if (step < 0) {
      EXPECT_EQ(u, std::vector<double>(150, 0.0));
    } else {
      EXPECT_EQ(u, of_step[static_cast<std::size_t>(step)]) << "whole, of step " << step;
    }
  }
  sunder_frame frame = SUNDER_FRAME_INIT;
  ASSERT_OK(sunder_frames_take(frames, &frame));
  EXPECT_EQ(frame.step, 199) << "the last one";
  EXPECT_OK(sunder_simulation_destroy(simulation));
  EXPECT_EQ(sunder_frames_take(frames, &frame), SUNDER_ERROR_HANDLE);
  EXPECT_OK(sunder_frames_destroy(frames));
}

/// The board with a grip of the scene's, torn and grasped by one thread.
sunder_simulation handled_board() {
  const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, 8);
  sunder_instrument grip = corner_pull();
  grip.kind = SUNDER_DISPLACEMENT;
  grip.nodes = box(-0.01, -0.01, 0.01, 0.01);
  EXPECT_OK(sunder_scene_add_instrument(scene, &grip, nullptr));
  EXPECT_OK(sunder_scene_set_live(scene, 1));
  EXPECT_OK(sunder_scene_set_steps(scene, 1 << 30));
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  EXPECT_OK(sunder_scene_destroy(scene));
  EXPECT_OK(sunder_simulation_keep_history(simulation, 10));
  return simulation;
}

/// Grasps, poses, steps, lets go, goes back and forth, until the simulation is gone: the status
/// that said so. `rounds`: how often so far.
sunder_status handle_until_gone(sunder_simulation simulation, std::atomic<int>& rounds) {
  sunder_status status = SUNDER_OK;
  const auto done = [&](sunder_status of) {
    status = of;
    return of == SUNDER_OK;
  };
  std::int32_t mark = 0;
  if (!done(sunder_simulation_save(simulation, &mark))) return status;
  for (int i = 0;; ++i) {
    const double pull[3] = {0, -0.5 * (i % 5), 0}, at[3] = {5, 0, 0.5};
    std::int32_t grip = 0;
    double place[3] = {};
    if (!done(sunder_simulation_drive(simulation, 0, pull)) ||
        !done(sunder_simulation_grasp_near(simulation, at, 1.5, 1, &grip)) ||
        !done(sunder_simulation_step(simulation, nullptr)) ||
        !done(sunder_simulation_grip_place(simulation, grip, place))) {
      return status;
    }
    place[0] += 0.01;
    const double turn[4] = {0, 0, 0.01, 1};
    if (!done(sunder_simulation_pose(simulation, grip, place, turn)) ||
        !done(sunder_simulation_step(simulation, nullptr)) ||
        !done(sunder_simulation_release(simulation, grip)) ||
        !done(sunder_simulation_undo(simulation, 1, nullptr, nullptr)) ||
        !done(sunder_simulation_step(simulation, nullptr)) ||
        !done(sunder_simulation_restore(simulation, mark, nullptr))) {
      return status;
    }
    ++rounds;
  }
}

// Three threads ask for what a fourth one makes of the body, and a fifth ends it in the midst.
TEST(CThreads, EverybodyAsksUntilTheBodyIsGone) {
  for (int time = 0; time < 4; ++time) {
    const sunder_simulation simulation = handled_board();
    sunder_grips grips = nullptr;
    sunder_frames frames = nullptr;
    ASSERT_OK(sunder_grips_create(simulation, &grips));
    ASSERT_OK(sunder_frames_create(simulation, SUNDER_FRAME_DISPLACEMENT | SUNDER_FRAME_STRESS,
                                   nullptr, 0, &frames));
    std::atomic<int> rounds{0}, felt_answers{0}, force_answers{0}, pictures{0}, wrong{0};
    // Hands and forces share a handle: one of the two is told that it is busy.
    const auto answers = [&wrong](sunder_status status, std::atomic<int>& count) {
      if (status == SUNDER_OK) ++count;
      const bool fine = status == SUNDER_OK || status == SUNDER_ERROR_ORDER ||
                        status == SUNDER_ERROR_BUSY || status == SUNDER_ERROR_HANDLE;
      if (!fine) ++wrong;
      std::this_thread::yield();
      return status != SUNDER_ERROR_HANDLE;
    };
    std::atomic<sunder_status> last{SUNDER_OK};
    std::vector<std::thread> threads;
    threads.emplace_back([&] { last = handle_until_gone(simulation, rounds); });
    threads.emplace_back([&] {
      sunder_felt felt = SUNDER_FELT_INIT;
      sunder_hand hand = SUNDER_HAND_INIT;
      sunder_status status = SUNDER_OK;
      for (int i = 0; answers(status, felt_answers); ++i) {
        hand.grip = 2 + i % 3;
        static_cast<void>(sunder_grips_blend(grips, i % 2 ? 5 : 0));
        status = sunder_grips_feel(grips, nullptr, nullptr, 0, &hand, 1, &felt);
        const bool told = felt.solution >= 1 && felt.age_ms >= 0 && felt.share >= 0 &&
                          felt.share <= 1 && std::isfinite(hand.force[0] + hand.torque[2]);
        if (status == SUNDER_OK && !told) ++wrong;
      }
    });
    threads.emplace_back([&] {
      const std::vector<double> held(6, 0.01);
      std::vector<double> forces(6);
      sunder_status status = SUNDER_OK;
      while (answers(status, force_answers)) {
        status = sunder_grips_forces(grips, held.data(), forces.data(), 6);
        if (!std::isfinite(forces[3] + forces[4] + forces[5])) ++wrong;
      }
    });
    threads.emplace_back([&] {
      sunder_frame frame = SUNDER_FRAME_INIT;
      std::vector<double> u(3 * 162), stress(6 * 384);
      sunder_status status = SUNDER_OK;
      while (answers(status, pictures)) {
        status = sunder_frames_take(frames, &frame);
        if (status == SUNDER_OK) status = sunder_frames_displacement(frames, u.data(), u.size());
        if (status == SUNDER_OK) {
          status = sunder_frames_stress(frames, stress.data(), stress.size());
        }
      }
    });
    const auto waits = [&] {
      return rounds < 2 + time || felt_answers < 10 || force_answers < 10 || pictures < 10;
    };
    while (waits() && last == SUNDER_OK) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    sunder_status ended = SUNDER_ERROR_BUSY;  // a sanitizer may hold a call up for longer
    while (ended == SUNDER_ERROR_BUSY) ended = sunder_simulation_destroy(simulation);
    EXPECT_OK(ended);
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(last == SUNDER_ERROR_HANDLE || last == SUNDER_ERROR_CANCELLED) << last;
    EXPECT_EQ(wrong, 0);
    EXPECT_OK(sunder_grips_destroy(grips));
    EXPECT_OK(sunder_frames_destroy(frames));
  }
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
