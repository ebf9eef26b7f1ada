// SPDX-License-Identifier: Apache-2.0
#include "app/view/haptic_loop.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace sunder::app {
namespace {

constexpr std::chrono::milliseconds kTick{1};
// A mouse tells its place some sixty times a second: the hand closes this share of the way to it in
// a tick, two thirds within 20 ms.
constexpr double kCloses = 0.05;
constexpr double kStill = 1e-9;  // of the way [mm] and of a quaternion: the hand rests
// A rupture is felt within so long, not at once.
constexpr double kBlend = 10;  // [ms]

}  // namespace

HapticLoop::HapticLoop(std::shared_ptr<InstrumentForces> forces,
                       std::function<void(const input::Pose&)> post)
    : post_(std::move(post)) {
  feel(std::move(forces));
  thread_ = std::thread([this] { run(); });
}

HapticLoop::~HapticLoop() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  thread_.join();
}

void HapticLoop::feel(std::shared_ptr<InstrumentForces> forces) {
  if (forces) forces->blend(kBlend);
  const std::lock_guard lock(mutex_);
  forces_ = std::move(forces);
}

void HapticLoop::hold(const input::Pose& where, int of_body) {
  const std::lock_guard lock(mutex_);
  of_body_ = of_body;
  hand_ = aim_ = told_ = where;
  holds_ = true;
}

void HapticLoop::aim(const Vec3& place, const std::array<double, 4>& quaternion) {
  const std::lock_guard lock(mutex_);
  aim_.position = place;
  aim_.quaternion = quaternion;
}

void HapticLoop::let_go() {
  const std::lock_guard lock(mutex_);
  holds_ = false;
  now_ = {};
}

HapticLoop::Now HapticLoop::now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void HapticLoop::run() {
  auto next = std::chrono::steady_clock::now();
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (over_) return;
    }
    tick();
    next += kTick;
    const auto now = std::chrono::steady_clock::now();
    if (next < now) next = now;  // ticks that were missed are not made up for
    std::this_thread::sleep_until(next);
  }
}

void HapticLoop::tick() {
  input::Pose tell;
  bool moved = false;
  std::shared_ptr<InstrumentForces> forces;
  sunder::Hand hand;
  {
    const std::lock_guard lock(mutex_);
    if (!holds_) return;
    forces = forces_;
    hand.grip = of_body_;
    hand_.position += kCloses * (aim_.position - hand_.position);
    double turned = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      hand_.quaternion[i] += kCloses * (aim_.quaternion[i] - hand_.quaternion[i]);
      turned = std::max(turned, std::abs(hand_.quaternion[i] - told_.quaternion[i]));
    }
    moved = (hand_.position - told_.position).norm() > kStill || turned > kStill;
    if (moved) told_ = hand_;
    tell = hand_;
  }
  hand.position = tell.position;
  hand.quaternion = tell.quaternion;
  Felt felt;
  if (forces) felt = forces->feel({}, {}, {&hand, 1});
  if (moved) post_(tell);
  const std::lock_guard lock(mutex_);
  if (holds_) now_ = {true, tell.position, hand.force, felt};
}

}  // namespace sunder::app
