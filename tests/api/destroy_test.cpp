// SPDX-License-Identifier: Apache-2.0
// Destroying returns at once while a thread makes a new base of the torn body.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>

#include "api/c_scene.hpp"
#include "c/simulation.hpp"
#include "cpu_reference/cpu_reference.hpp"

namespace sunder::test {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// More than the promise: a destroy that waited for a thread that rests so long would break it.
constexpr milliseconds kRest(200);
constexpr double kPromise = 50;  // ms, by sunder.h
constexpr Index kCells = 16;
constexpr int kMostEvents = 200;
/// From its start to the event that finds it in place: at least so many (solver/frame_cost.hpp).
constexpr int kFewestFrames = 48;

/// A board from which elements are taken, one at a time; nothing else breaks. Its thread rests
/// before each thing that it does.
class LosingBoard {
 public:
  LosingBoard(std::int32_t route, milliseconds rest) {
    const sunder_scene scene = board_scene(SUNDER_BACKEND_CPU, kCells, -0.01);
    const auto none = model(SUNDER_FRACTURE_NONE);
    EXPECT_OK(sunder_scene_set_fracture(scene, &none));
    EXPECT_OK(sunder_scene_set_live(scene, 1));
    auto solver = on(SUNDER_BACKEND_CPU);
    solver.route = route;
    solver.update = SUNDER_UPDATE_DEFERRED;
    EXPECT_OK(sunder_scene_set_solver(scene, &solver));
    const auto create = [rest](std::shared_ptr<const Problem> problem, Needs needs,
                               const std::shared_ptr<PipelineCache>&) {
      return CreatedBackend{
          cpu_reference::create(std::move(problem), std::move(needs), {.rest = rest}), {}};
    };
    const sunder_callbacks silent = SUNDER_CALLBACKS_INIT;
    auto object = std::make_shared<c::SimulationObject>(*c::find<c::SceneObject>(scene, "scene"),
                                                        silent, create, true);
    object_ = object.get();
    left_ = object->gone;
    handle_ = c::new_handle<sunder_simulation>(std::move(object));
    EXPECT_OK(sunder_scene_destroy(scene));
    EXPECT_OK(sunder_simulation_step(handle_, nullptr));
  }
  ~LosingBoard() {
    if (handle_) destroy();
    while (alive()) std::this_thread::sleep_for(milliseconds(1));  // or it never goes
  }
  LosingBoard(const LosingBoard&) = delete;
  LosingBoard& operator=(const LosingBoard&) = delete;

  /// One of each cell's six, here and there: nothing comes loose, no base is needed at once.
  void lose_one() {
    const std::int32_t element = 6 * (37 * events_++ % (kCells * kCells)) + 2;
    EXPECT_OK(sunder_simulation_remove(handle_, &element, 1));
  }
  [[nodiscard]] int events() const { return events_; }
  [[nodiscard]] bool has_new_base() const {
    const auto buffers = object_->simulation().backend().buffers();
    return std::any_of(buffers.begin(), buffers.end(),
                       [](const auto& b) { return b.name.starts_with("damaged factor"); });
  }
  /// Milliseconds that it took.
  double destroy() {
    const auto start = Clock::now();
    EXPECT_OK(sunder_simulation_destroy(handle_));
    handle_ = nullptr;
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  /// Whether anything of the simulation is still there.
  [[nodiscard]] bool alive() const { return !left_.expired(); }

 private:
  c::SimulationObject* object_ = nullptr;
  std::weak_ptr<const std::atomic<bool>> left_;  // goes after all that makes a base
  sunder_simulation handle_ = nullptr;
  int events_ = 0;
};

/// The event that finds the first new base in place, the same one however long that takes: at the
/// event before, the base is in the making.
int event_that_takes_a_base(std::int32_t route) {
  LosingBoard board(route, milliseconds(0));
  while (!board.has_new_base() && board.events() < kMostEvents) board.lose_one();
  EXPECT_TRUE(board.has_new_base());
  EXPECT_GT(board.events(), kFewestFrames) << "it was made in the frame";
  return board.events();
}

class CDestroy : public testing::TestWithParam<std::int32_t> {};

// What waits for the thread is late each time; a machine that is busy elsewhere is not.
TEST_P(CDestroy, DoesNotWaitForABaseInTheMaking) {
  const int taken = event_that_takes_a_base(GetParam());
  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 10 && least > kPromise; ++attempt) {
    LosingBoard board(GetParam(), kRest);
    while (board.events() < taken - 1) board.lose_one();
    EXPECT_FALSE(board.has_new_base());
    const double took = board.destroy();
    if (took <= kPromise) {
      EXPECT_TRUE(board.alive()) << "the thread was done: no base was in the making";
    }
    least = std::min(least, took);
  }
  EXPECT_LE(least, kPromise);
}

// The thread at work, wherever in its factor it is: it may begin sooner than 48 events before.
TEST_P(CDestroy, StopsTheFactorOfABase) {
  const int taken = event_that_takes_a_base(GetParam());
  for (const int before : {47, 44}) {
    double least = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < 10 && least > kPromise; ++attempt) {
      LosingBoard board(GetParam(), milliseconds(0));
      while (board.events() < taken - before) board.lose_one();
      least = std::min(least, board.destroy());
    }
    EXPECT_LE(least, kPromise) << before << " events before the base is taken";
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, CDestroy,
                         testing::Values(SUNDER_ROUTE_FACTOR, SUNDER_ROUTE_INVERSE),
                         [](const auto& test) {
                           return test.param == SUNDER_ROUTE_FACTOR ? "factor" : "inverse";
                         });

}  // namespace
}  // namespace sunder::test
