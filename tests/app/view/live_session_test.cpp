// SPDX-License-Identifier: Apache-2.0
// A session on a thread of its own: what is drawn is the last finished frame, and what goes wrong
// pauses and is told.
#include "app/view/live_session.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <thread>

#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using namespace app;
using namespace std::chrono_literals;

struct Live {
  explicit Live(Scene scene = strip(0.6, 0.2, 1000000)) {
    scene.live = true;
    problem = std::make_shared<const Problem>(std::move(scene));
    session.emplace(
        problem, [p = problem] { return create_backend(p, needs_of(*p)).backend; }, true,
        PictureSize{});
    live.emplace(*session);
  }
  /// Until it is so, at most so long.
  [[nodiscard]] bool within(std::chrono::seconds limit,
                            const std::function<bool(const LiveSession::Now&)>& so) const {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end) {
      if (so(live->now())) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  static int steps(const LiveSession::Now& now) {
    return now.shown->report ? now.shown->report->step + 1 : 0;
  }
  std::string recording() {
    std::promise<std::string> got;
    live->record([&](const std::string& inputs, const Origin&) { got.set_value(inputs); });
    return got.get_future().get();
  }

  std::shared_ptr<const Problem> problem;
  std::optional<Session> session;
  std::optional<LiveSession> live;
};

TEST(LiveSession, BeginsPausedWithTheBodyAsItIs) {
  Live live;
  EXPECT_TRUE(live.live->paused());
  const auto now = live.live->now();
  ASSERT_TRUE(now.shown);
  EXPECT_FALSE(now.shown->triangles.empty());
  EXPECT_EQ(Live::steps(now), 0);
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(Live::steps(live.live->now()), 0);
}

TEST(LiveSession, GoesOnUntilPausedAndStepsSingly) {
  Live live;
  live.live->pause(false);
  EXPECT_TRUE(live.within(60s, [](const auto& now) { return Live::steps(now) >= 3; }));
  live.live->pause(true);
  const std::string before = live.recording();  // comes after the step in work
  live.live->post(input::Step{});
  const std::string after = live.recording();
  const auto count = [](const std::string& inputs) {
    return std::stoi(inputs.substr(inputs.find(' ') + 1));
  };
  EXPECT_EQ(count(after), count(before) + 1);
}

TEST(LiveSession, AllStepsDoneItRests) {
  Live live(strip(0.6, 0.2, 4));
  live.live->pause(false);
  EXPECT_TRUE(live.within(60s, [](const auto& now) { return now.done; }));
  EXPECT_EQ(live.recording(), "step 4\n");
  live.live->pause(true);
  live.live->post(input::Reset{});
  EXPECT_TRUE(live.within(60s, [](const auto& now) { return !now.done && Live::steps(now) == 0; }));
  EXPECT_EQ(live.recording(), "");
}

TEST(LiveSession, WhatGoesWrongPausesAndIsTold) {
  Live live;
  live.live->pause(false);
  live.live->post(input::Remove{{40}});
  live.live->post(input::Remove{{40}});
  ASSERT_TRUE(live.within(60s, [](const auto& now) { return now.error.has_value(); }));
  EXPECT_TRUE(live.live->paused());
  const auto now = live.live->now();
  EXPECT_EQ(now.error->find("element 40 cannot be removed"), 0U) << *now.error;
  EXPECT_EQ(now.shown->state.destroyed[40], 1);  // what was done before stays
  live.live->post(input::Undo{});
  EXPECT_TRUE(live.within(60s, [](const auto& n) {
    return !n.error && n.shown->state.destroyed[40] == 0 && n.redos == 1;
  }));
}

TEST(LiveSession, AFrameThatIsRefusedPausesAndTheLastOneStays) {
  Live live;
  live.live->post(input::Step{});
  ASSERT_TRUE(live.within(60s, [](const auto& now) { return Live::steps(now) == 1; }));
  const auto before = live.live->now().shown->places;
  live.live->post(input::Drive{"forceps", Vec3(0, -1e308, 0), false, 0});  // beyond numbers
  live.live->pause(false);
  ASSERT_TRUE(live.within(60s, [](const auto& now) { return now.error.has_value(); }));
  EXPECT_TRUE(live.live->paused());
  EXPECT_EQ(Live::steps(live.live->now()), 1);
  EXPECT_EQ(live.live->now().shown->places, before);
  live.live->post(input::Drive{"forceps", Vec3(0, -0.1, 0), false, 0});
  live.live->pause(false);
  EXPECT_TRUE(live.within(60s, [](const auto& now) { return !now.error && Live::steps(now) > 3; }));
}

TEST(LiveSession, DrivingAgainTakesThePlaceOfWhatWasNotDone) {
  Live live;
  std::promise<void> begin;
  live.live->record([&](const std::string&, const Origin&) { begin.get_future().wait(); });
  std::this_thread::sleep_for(5ms);
  for (int i = 1; i <= 9; ++i) live.live->post(input::Drive{"forceps", Vec3(0, -i, 0), false, 0});
  begin.set_value();
  const std::string inputs = live.recording();
  EXPECT_EQ(inputs, "drive \"forceps\" 0 -9 0\n");
  EXPECT_TRUE(live.within(60s, [](const auto& n) { return n.values.at(0) == Vec3(0, -9, 0); }));
}

TEST(LiveSession, NobodyWaitsForAStep) {
  Live live;
  std::promise<void> end;
  live.live->record(
      [&](const std::string&, const Origin&) { end.get_future().wait(); });  // a long one
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(live.live->now().shown);
    live.live->post(input::Step{});
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 5s);
  end.set_value();
}

}  // namespace
}  // namespace sunder::test
