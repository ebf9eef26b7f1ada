// SPDX-License-Identifier: Apache-2.0
// A simulation on the device that draws, which is lost: it moves to the new one with all that was
// done, whoever finds the loss first.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <string_view>
#include <thread>

#include "app/view/live_session.hpp"
#include "app/view/painter.hpp"
#include "core/frame/run_state.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app;
using namespace std::chrono_literals;

constexpr PictureSize kSmall{160, 120};

/// A device's functions as they are lent to a simulation: its submits can be made to fail.
struct LentFunctions {
  static inline std::atomic<bool> lost{false};
  static inline PFN_vkGetInstanceProcAddr instance = nullptr;
  static inline PFN_vkGetDeviceProcAddr device = nullptr;
  static inline PFN_vkQueueSubmit submit = nullptr;

  static VKAPI_ATTR VkResult VKAPI_CALL submit_or_lose(VkQueue queue, std::uint32_t count,
                                                       const VkSubmitInfo* infos, VkFence fence) {
    return lost ? VK_ERROR_DEVICE_LOST : submit(queue, count, infos, fence);
  }
  static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL of_device(VkDevice of, const char* name) {
    const PFN_vkVoidFunction found = device(of, name);
    if (std::string_view(name) != "vkQueueSubmit") return found;
    submit = reinterpret_cast<PFN_vkQueueSubmit>(found);
    return reinterpret_cast<PFN_vkVoidFunction>(&submit_or_lose);
  }
  static sunder_vulkan_function of_instance(void* of, const char* name) {
    const PFN_vkVoidFunction found = instance(static_cast<VkInstance>(of), name);
    if (std::string_view(name) != "vkGetDeviceProcAddr") return found;
    device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(found);
    return reinterpret_cast<sunder_vulkan_function>(&of_device);
  }
  /// What was lent before goes on failing as this does.
  static sunder_vulkan_host lend(view::Device& drawing) {
    sunder_vulkan_host host = drawing.lend();
    instance = drawing.get();
    host.get_instance_proc_addr = &of_instance;
    return host;
  }
};

class LostSimulation : public testing::Test {
 protected:
  void SetUp() override {
    LentFunctions::lost = false;
    Scene scene = strip(1e9, 0.2, 40);
    scene.live = true;
    scene.solver.backend = "vulkan";
    problem = std::make_shared<const Problem>(std::move(scene));
    session.emplace(
        problem, [this] { return make(); }, true, kSmall);
  }
  std::unique_ptr<Backend> make() {
    lent.push_back(&devices.now());
    return create_backend_on(problem, needs_of(*problem), LentFunctions::lend(devices.now()))
        .backend;
  }
  /// As it is drawn by the device that draws now.
  std::vector<std::uint8_t> picture() {
    Painter painter(devices.now(), kSmall);
    painter.draw(session->show(0), session->look(), session->camera());
    return painter.pixels().rgba;
  }

  std::vector<const view::Device*> lent;
  view::Devices devices{view::DeviceOptions{}};
  std::shared_ptr<const Problem> problem;
  std::optional<Session> session;
};

TEST_F(LostSimulation, MovesToTheNewDeviceToTheSameBits) {
  for (int i = 0; i < 3; ++i) session->step();
  session->hand().remove(std::vector<Index>{100, 101});
  session->step();
  ASSERT_GT(session->simulation().undos(), 0);
  const std::vector<std::uint8_t> before = picture();
  const RunState state(session->simulation());
  const view::Device* const first = &devices.now();
  devices.renew();
  session->renew();
  EXPECT_NE(first, &devices.now());
  EXPECT_EQ(lent, (std::vector<const view::Device*>{first, &devices.now()}));
  expect_same_bits(RunState(session->simulation()), state);
  EXPECT_EQ(picture(), before);
  session->hand().undo(1);
  EXPECT_EQ(session->simulation().backend().destroyed()[100], 0);
  session->hand().redo(1);
  session->step();
  session->hand().undo(1);
  session->hand().redo(1);
  EXPECT_EQ(session->simulation().backend().destroyed()[100], 1);
}

TEST_F(LostSimulation, WhatItsOwnThreadFindsPausesIsToldAndLosesNothing) {
  for (int i = 0; i < 3; ++i) session->step();
  session->hand().remove(std::vector<Index>{100, 101});
  session->step();
  const RunState state(session->simulation());
  const std::vector<std::uint8_t> before = picture();
  LiveSession live(*session);
  const auto recording = [&] {
    std::promise<std::string> got;
    live.record([&](const std::string& inputs, const Origin&) { got.set_value(inputs); });
    return got.get_future().get();
  };
  const auto until = [&](const auto& so) {
    const auto end = std::chrono::steady_clock::now() + 120s;
    while (!so(live.now()) && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(1ms);
    }
    return so(live.now());
  };
  const auto told = [](const LiveSession::Now& now) { return now.error.has_value(); };
  const std::string done = recording();
  LentFunctions::lost = true;
  live.pause(false);
  ASSERT_TRUE(until(told));
  EXPECT_NE(live.now().error->find("lost"), std::string::npos) << *live.now().error;
  EXPECT_TRUE(live.paused());
  EXPECT_EQ(recording(), done);
  // Then as a window does: the next picture finds it too.
  LentFunctions::lost = false;
  devices.renew();
  const std::string why = "it was lost; there is a new one";
  live.renew(why);
  ASSERT_TRUE(until([&](const LiveSession::Now& now) { return now.error == why; }));
  EXPECT_TRUE(live.paused());
  EXPECT_EQ(recording(), done);
  EXPECT_EQ(lent.back(), &devices.now());
  expect_same_bits(RunState(session->simulation()), state);
  EXPECT_EQ(picture(), before);
  live.post(input::Step{});
  EXPECT_NE(recording(), done);
  EXPECT_EQ(session->simulation().steps_done(), state.steps + 1);
}

}  // namespace
}  // namespace sunder::test
