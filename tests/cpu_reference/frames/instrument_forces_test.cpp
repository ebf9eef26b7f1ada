// SPDX-License-Identifier: Apache-2.0
// Instruments ask for their forces at any time while frames tear the body.
#include "sunder/instrument_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <limits>
#include <thread>

#include "sunder/error.hpp"
#include "support/body.hpp"
#include "support/haptic_reader.hpp"
#include "support/sequences.hpp"
#include "support/table1_board.hpp"

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
#endif

namespace sunder::test {
namespace {

Scene gripped_board(Route route) {
  Scene scene = pulled_board();
  scene.instruments[0].action = Grip{lower_right_corner(), Vec3::Constant(0.25), Axes{7}};
  scene.solver.route = route;
  return scene;
}

TEST(InstrumentForces, AreTheReactionsOfTheFrame) {
  for (Route route : {Route::inverse, Route::factor}) {
    const Body body(gripped_board(route));
    const auto instruments = body.backend->instrument_forces();
    ASSERT_TRUE(instruments);
    const std::size_t grips = body.problem->gripped_dofs().size();
    std::vector<double> held(grips, 0.25), forces(grips, -1);
    EXPECT_FALSE(instruments->forces(held, forces)) << "before the first frame";
    EXPECT_EQ(forces, std::vector<double>(grips, 0.0));
    const std::vector<double> none(body.problem->dofs().size(), 0.0);
    for (Index e : crack_sequence(*body.problem, 12, 8)) {
      body.backend->destroy({&e, 1});
      body.load(none, held);
      body.backend->solve();
      ASSERT_TRUE(instruments->forces(held, forces));
      const auto reactions = body.reactions();
      double largest = 0;
      for (double r : reactions) largest = std::max(largest, std::abs(r));
      for (std::size_t g = 0; g < grips; ++g) {
        EXPECT_NEAR(forces[g], reactions[g], 1e-8 * largest) << g;
      }
    }
    // Elsewhere: what a frame with that displacement says.
    std::vector<double> moved(grips);
    for (std::size_t g = 0; g < grips; ++g) moved[g] = 0.1 * static_cast<double>(g % 3);
    ASSERT_TRUE(instruments->forces(moved, forces));
    body.load(none, moved);
    body.backend->solve();
    const auto reactions = body.reactions();
    double largest = 0;
    for (double r : reactions) largest = std::max(largest, std::abs(r));
    for (std::size_t g = 0; g < grips; ++g) {
      EXPECT_NEAR(forces[g], reactions[g], 1e-7 * largest) << g;
    }
  }
}

TEST(InstrumentForces, RefuseWhatIsNotFinite) {
  InstrumentForces instruments(std::vector<double>{0, 0});
  const Eigen::MatrixXd l = Eigen::MatrixXd::Identity(2, 2);
  std::vector<double> forces(2);
  instruments.publish(l * std::nan(""), Eigen::VectorXd::Zero(2));
  EXPECT_EQ(instruments.frames(), 0u);
  instruments.publish(l, Eigen::VectorXd::Zero(2));
  EXPECT_FALSE(instruments.forces(std::vector<double>{1, std::nan("")}, forces));
  EXPECT_EQ(forces, (std::vector<double>{0, 0}));
  EXPECT_TRUE(instruments.forces(std::vector<double>{1, 2}, forces));
  EXPECT_EQ(forces, (std::vector<double>{1, 2}));
  EXPECT_THROW(instruments.forces(std::vector<double>{1}, forces), UsageError);
}

class WhileFramesTear : public ::testing::TestWithParam<Route> {
 protected:
  const Body body_{gripped_board(GetParam())};
  const std::vector<double> held_ = std::vector<double>(body_.problem->gripped_dofs().size(), 0.25);

  /// A tear long enough for a new base; `each` after every frame.
  template <class Each>
  void tear(Each&& each) const {
    const std::vector<double> none(body_.problem->dofs().size(), 0.0);
    for (Index e : crack_sequence(*body_.problem, 240, 8)) {
      body_.backend->destroy({&e, 1});
      body_.load(none, held_);
      body_.backend->solve();
      each();
    }
  }

  [[nodiscard]] bool has_new_base() const {
    return std::ranges::any_of(body_.backend->buffers(), [](const BufferPlan& b) {
      return b.name.starts_with("damaged factor") || b.name.starts_with("stiffness lost");
    });
  }
};

// The figures are printed by the benchmark; here: every answer is one frame's, whole and finite.
TEST_P(WhileFramesTear, EveryAnswerIsAFrames) {
  const auto instruments = body_.backend->instrument_forces();
  HapticReader reader(*instruments, held_);
  Pulls frames;
  tear([&] { frames.add(body_.reactions()); });
  const Pulls answers = reader.end();
  EXPECT_TRUE(has_new_base());
  EXPECT_EQ(answers.bad, 0);
  EXPECT_GE(answers.least, frames.least * (1 - 1e-7));
  EXPECT_LE(answers.most, frames.most * (1 + 1e-7));
}

#if defined(_WIN32)

/// Holds a thread wherever it is, whatever locks it has, until it is let go.
class Hold {
 public:
  void take(std::thread& thread) const {
    held_ = pthread_gethandle(thread.native_handle());
    SuspendThread(held_);
    CONTEXT context{};  // asked for, it says that the thread stands
    context.ContextFlags = CONTEXT_CONTROL;
    GetThreadContext(held_, &context);
  }
  void let_go() const { ResumeThread(held_); }

 private:
  mutable HANDLE held_ = nullptr;
};

#else

/// Holds a thread wherever it is, whatever locks it has, until it is let go.
class Hold {
 public:
  Hold() {
    struct sigaction action {};
    action.sa_handler = &Hold::wait;
    sigaction(SIGUSR1, &action, &before_);
  }
  ~Hold() { sigaction(SIGUSR1, &before_, nullptr); }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;

  static void take(std::thread& thread) {
    release_ = false;
    pthread_kill(thread.native_handle(), SIGUSR1);
    while (!held_) std::this_thread::yield();
  }
  static void let_go() {
    release_ = true;
    while (held_) std::this_thread::yield();
  }

 private:
  static void wait(int) {
    const int error = errno;
    held_ = true;
    while (!release_) {
      const timespec pause{0, 20000};
      nanosleep(&pause, nullptr);
    }
    held_ = false;
    errno = error;
  }
  static inline std::atomic<bool> held_{false}, release_{false};
  struct sigaction before_ {};
};

#endif

// By logic, not by the clock: the frame's thread stands still in the middle of its work, with the
// allocator's lock perhaps, and an answer that waited for it would never come.
TEST_P(WhileFramesTear, NoAnswerWaitsForAFrame) {
  const auto instruments = body_.backend->instrument_forces();
  std::atomic<bool> torn{false}, leave{false};
  const Hold hold;
  std::thread frames([&] {
    tear([] {});
    torn = true;
    while (!leave) body_.backend->solve();
  });
  std::vector<double> forces(held_.size());
  // Until the first frame is handed over, which is a little after it has been counted.
  while (!instruments->forces(held_, forces)) std::this_thread::yield();
  constexpr long kHolds = 20;  // a quick machine may tear the body in fewer
  long answers = 0, bad = 0, holds = 0;
  for (; !torn || holds < kHolds; ++holds) {
    hold.take(frames);
    for (int i = 0; i < 10; ++i) {
      const bool answered = instruments->forces(held_, forces);
      answers += answered;
      for (double f : forces) bad += !std::isfinite(f);
    }
    hold.let_go();
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  leave = true;
  frames.join();
  EXPECT_TRUE(has_new_base());
  EXPECT_EQ(answers, 10 * holds);
  EXPECT_EQ(bad, 0);
}

INSTANTIATE_TEST_SUITE_P(Routes, WhileFramesTear,
                         ::testing::Values(Route::inverse, Route::condensed, Route::factor),
                         [](const auto& p) {
                           return p.param == Route::inverse     ? "Inverse"
                                  : p.param == Route::condensed ? "Condensed"
                                                                : "Factor";
                         });

// What a numerical failure may leave in a frame never comes out as a force.
TEST(InstrumentForces, AreNeverNaN) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  InstrumentForces instruments(std::vector<double>{0, 0});
  std::vector<double> forces(2);
  const auto ask = [&](double a, double b) {
    const bool answered = instruments.forces(std::vector<double>{a, b}, forces);
    EXPECT_TRUE(std::isfinite(forces[0]) && std::isfinite(forces[1]));
    EXPECT_TRUE(answered || forces == (std::vector<double>{0, 0}));
    return answered;
  };
  Eigen::Matrix2d l = Eigen::Matrix2d::Identity();
  EXPECT_FALSE(ask(1, 2));
  instruments.publish(l, Eigen::Vector2d::Zero());
  EXPECT_TRUE(ask(1, 2));
  for (double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(ask(bad, 1));
    for (int row : {0, 1}) {
      Eigen::Matrix2d damaged = l;
      damaged(row, 0) = bad;  // on the diagonal and under it
      instruments.publish(damaged, Eigen::Vector2d::Zero());
      ask(1, 2);
      Eigen::Vector2d u = Eigen::Vector2d::Zero();
      u[row] = bad;
      instruments.publish(l, u);
      ask(1, 2);
    }
  }
  for (double zero : {0.0, -1.0}) {
    l(1, 1) = zero;
    instruments.publish(l, Eigen::Vector2d::Zero());
    ask(1, 2);
  }
  l(1, 1) = 1e-200;
  instruments.publish(l, Eigen::Vector2d::Zero());
  EXPECT_FALSE(ask(1e300, 1e300)) << "it overflows";
}

}  // namespace
}  // namespace sunder::test
