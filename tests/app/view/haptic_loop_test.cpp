// SPDX-License-Identifier: Apache-2.0
// A hand on a thread of its own holds the tissue of a session, and random input that goes on and
// on: seconds here, an hour in the soak (SUNDER_VIEW_SECONDS).
#include "app/view/haptic_loop.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <limits>
#include <random>
#include <thread>

#include "app/view/live_session.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using app::HapticLoop;
using app::LiveSession;
using app::Session;
using namespace std::chrono_literals;
namespace input = app::input;

struct Held {
  explicit Held(double yield = 1e9) {
    const app::BodyPlan first = plan(yield, 5);
    session.emplace(first.problem, first.make, true, app::PictureSize{});
    session->can_change({}, [this](const app::Origin& origin) {
      double to[2] = {1, 1};  // "yield=", "young="
      for (const std::string& c : origin.changes)
        to[c[0] == 'y' && c[1] == 'o'] = std::stod(c.substr(6));
      return plan(to[0], to[1]);
    });
    live.emplace(*session);
    loop.emplace(live->now().forces, [this](const input::Pose& pose) { live->post(pose); });
  }
  ~Held() { loop.reset(); }
  [[nodiscard]] app::BodyPlan plan(double yield, double young) const {
    Scene scene = strip(yield, 0.2, 1 << 30);
    scene.materials.begin()->second.young = young;
    scene.fracture.model = FractureModel::a;
    scene.live = true;
    scene.solver.route = Route::inverse;
    const auto problem = std::make_shared<const Problem>(std::move(scene));
    return {problem,
            [problem, prepared = prepared] {
              return create_prepared_backend(problem, needs_of(*problem), prepared).backend;
            },
            {}};
  }
  [[nodiscard]] static bool within(std::chrono::seconds limit, const std::function<bool()>& so) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < end) {
      if (so()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }

  /// The same, but a machine that leaves it little of its processors is given longer: until so much
  /// of their time has been its own.
  [[nodiscard]] static bool within_own(std::chrono::seconds limit,
                                       const std::function<bool()>& so) {
    constexpr double kOwn = 10;  // [s]; a reset takes under one
    const std::clock_t begin = std::clock();
    while (!within(limit, so)) {
      if (static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC > kOwn) return false;
    }
    return true;
  }

  std::shared_ptr<cpu_reference::PreparedBodies> prepared = prepared_bodies(2);
  std::optional<Session> session;
  std::optional<LiveSession> live;
  std::optional<HapticLoop> loop;
};

TEST(HapticLoop, AHandHoldsTissueAndFeelsIt) {
  Held held;
  LiveSession& live = *held.live;
  live.post(input::Step{});
  live.post(input::Grasp{{10, 15, 20}, Vec3::Zero(), 0, true});
  ASSERT_TRUE(held.within(20s, [&] { return live.now().grips.size() == 1; }));
  const auto grip = live.now().grips.front();
  EXPECT_EQ(grip.grip, 1);
  EXPECT_FALSE(held.loop->now().holds);
  const Vec3 there = grip.place + Vec3(-0.1, 0, 0);
  held.loop->hold({grip.grip, grip.place, {0, 0, 0, 1}}, grip.of_body);
  held.loop->aim(there, {0, 0, 0, 1});
  live.pause(false);
  ASSERT_TRUE(held.within(20s, [&] {
    const auto hand = held.loop->now();
    return hand.felt.state == FeltState::live && hand.force.norm() > 1e-3 &&
           (hand.place - there).norm() < 1e-3;
  }));
  ASSERT_TRUE(held.within(20s, [&] {
    return (live.now().grips.front().place - there).norm() < 1e-3;
  })) << "the body follows";
  held.loop->let_go();
  live.post(input::Release{grip.grip});
  ASSERT_TRUE(held.within(20s, [&] { return live.now().grips.empty(); }));
  EXPECT_FALSE(live.now().error) << *live.now().error;
  EXPECT_FALSE(held.loop->now().holds);
}

std::size_t heap() { return mallinfo2().uordblks + mallinfo2().hblkhd; }
/// [bytes] What one body may hold more than another: its bases, room for updates of its inverse.
constexpr std::size_t kSlack = std::size_t{16} << 20;

/// What hands may do, by chance; some of it cannot be done, pauses and is told.
class RandomHands {
 public:
  explicit RandomHands(Held& held) : held_(held) {}

  void act() {
    LiveSession& live = *held_.live;
    const auto now = live.now();
    if (live.paused() && below(2) == 0) live.pause(false);
    switch (below(13)) {
      case 0:
        live.post(input::Grasp{{static_cast<Index>(below(90))}, Vec3::Zero(), 0, false});
        break;
      case 1:
        live.post(input::Grasp{{}, Vec3(part(4), part(8), part(1)), 0.5 + part(1.5), true});
        break;
      case 2:
      case 3:
        if (now.grips.empty()) break;
        hold(now.grips[below(static_cast<unsigned>(now.grips.size()))]);
        break;
      case 4:
        held_.loop->let_go();
        if (!now.grips.empty()) live.post(input::Release{now.grips.front().grip});
        break;
      case 5:
        live.post(input::Drive{"forceps", Vec3(part(0.2), -part(0.4), 0), false, 0});
        break;
      case 6: {
        const double y = part(8);
        live.post(input::Cut{
            {Vec3(-1, y, -1), Vec3(-1, y, 2), Vec3(part(2), y, -1), Vec3(part(2), y, 2)}});
        break;
      }
      case 7:
        live.post(input::Undo{1});
        break;
      case 8:
        live.post(input::Redo{1});
        break;
      case 11:
        if (below(8) > 0) break;  // rarely: it takes everything along
        live.post(input::Set{
            {"yield=" + std::to_string(below(2) + 0.5), "young=" + std::to_string(below(2) + 4)}});
        break;
      case 9:
        live.pause(below(2) == 0);
        break;
      case 10:
        live.post(input::Step{});
        break;
      default:
        live.post(input::Remove{{static_cast<Index>(below(192))}});
    }
  }

 private:
  void hold(const LiveSession::HeldNodes& grip) {
    held_.loop->hold({grip.grip, grip.place, {0, 0, 0, 1}}, grip.of_body);
    held_.loop->aim(grip.place + Vec3(part(0.6) - 0.3, part(0.6) - 0.3, 0), {0, 0, 0, 1});
  }
  unsigned below(unsigned n) { return static_cast<unsigned>(random_()) % n; }
  double part(double of) { return std::uniform_real_distribution<double>(0, of)(random_); }

  Held& held_;
  std::mt19937 random_{24};
};

double seconds() {
  const char* asked = std::getenv("SUNDER_VIEW_SECONDS");
  return asked ? std::atof(asked) : 4;
}

TEST(HapticLoop, RandomInputNeitherStopsNorLeaks) {
  Held held(1.2);
  RandomHands hands(held);
  const auto begin = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  // A reset lets go of all that a history holds; from reset to reset the heap is the same. What is
  // given up is freed beside the frames, on a busy machine a while later: a leak never is.
  std::size_t least = std::numeric_limits<std::size_t>::max();  // [bytes] from the third reset on
  long acts = 0, resets = 0;
  do {
    for (int i = 0; i < 300; ++i, ++acts) {
      hands.act();
      std::this_thread::sleep_for(1ms);
    }
    held.loop->let_go();
    held.live->pause(true);
    held.live->post(input::Reset{});
    ASSERT_TRUE(held.within_own(60s,
                                [&] {
                                  const auto now = held.live->now();
                                  return now.undos == 0 && now.grips.empty() && !now.shown->report;
                                }))
        << "it has stopped after " << acts << " inputs";
    if (++resets < 3) continue;
    least = std::min(least, heap());
    ASSERT_TRUE(held.within_own(60s, [&] { return heap() < least + kSlack; }))
        << acts << " inputs and " << resets << " resets: the heap has " << heap()
        << " bytes where it had " << least;
  } while (since() < seconds() || resets < 4);
  RecordProperty("inputs", std::to_string(acts));
  std::cout << acts << " inputs in " << since() << " s, " << held.live->now().body
            << " changes of the body, " << resets << " resets; heap " << heap()
            << " bytes, the least " << least << std::endl;
}

}  // namespace
}  // namespace sunder::test
