// SPDX-License-Identifier: Apache-2.0
// A hand that does anything at all to a live session, round after round: what was recorded does the
// same again, bit by bit, and a reset leaves the body as it was.
#include <gtest/gtest.h>

#include <future>
#include <random>
#include <string>

#include "app/view/live_session.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using namespace app;

constexpr int kActions = 120;  // a round

class RandomHand {
 public:
  RandomHand(const Problem& problem, unsigned seed) : problem_(problem), random_(seed) {}

  InputAction next() {
    switch (below(20)) {
      case 0:
        return input::Remove{{below(problem_.tet_count() + 1)}};  // the last one is not there
      case 1:
        return input::Cut{{place(), place(), place()}};
      case 2:
        return input::Stroke{{point(), point(), point()}};
      case 3:
      case 4:
        return input::Undo{1 + below(4)};
      case 5:
        return input::Redo{1 + below(4)};
      case 6:
        return input::Camera{360 * part(), 180 * part() - 90, 0.2 + 3 * part()};
      case 7:
        return input::Look{part() < 0.5 ? std::optional(place()) : std::nullopt};
      case 8:
        return input::Colour{static_cast<Field>(below(4)), std::nullopt};
      case 9:
        return input::Clip{Vec3(0, 1, 0), 8 * part()};
      case 10:
        return input::Show{static_cast<input::Show::What>(below(4)), part() < 0.5};
      case 11:
        return input::Turn{"forceps", place(), 0};  // which a force does not do
      case 12:
      case 13:
        return input::Step{1 + below(3)};
      case 14:
        return input::Drive{"forceps", 1e9 * place(), false, 0};  // a hand gone wild
      default:
        return input::Drive{"forceps", Vec3(part() - 0.5, -2 * part(), part() - 0.5), part() < 0.3,
                            0};
    }
  }
  int below(int end) { return std::uniform_int_distribution(0, end - 1)(random_); }

 private:
  double part() { return std::uniform_real_distribution(0.0, 1.0)(random_); }
  Vec3 place() { return {6 * part() - 1, 10 * part() - 1, 3 * part() - 1}; }
  Vec2 point() { return {part(), part()}; }

  const Problem& problem_;
  std::mt19937 random_;
};

struct Rounds {
  explicit Rounds(Route route) {
    Scene scene = strip(0.6, 0.2, 1000000);
    scene.live = true;
    scene.solver.route = route;
    problem = std::make_shared<const Problem>(std::move(scene));
    session.emplace(problem, make(), true, PictureSize{320, 240});
    live.emplace(*session);
    first = live->now().shown;
  }
  [[nodiscard]] Simulation::MakeBackend make() const {
    return [p = problem] { return create_backend(p, needs_of(*p)).backend; };
  }
  /// After everything that was posted; what came of it is shown then.
  std::string recording() {
    static_cast<void>(recorded());
    return recorded();
  }
  std::string recorded() {
    std::promise<std::string> got;
    live->record([&](const std::string& inputs, const Origin&) { got.set_value(inputs); });
    return got.get_future().get();
  }

  void round(unsigned seed) {
    SCOPED_TRACE("round " + std::to_string(seed));
    RandomHand hand(*problem, seed);
    for (int i = 0; i < kActions; ++i) {
      live->post(hand.next());
      if (hand.below(3) == 0) live->pause(false);
      if (hand.below(8) == 0) static_cast<void>(recording());
      const auto now = live->now();
      if (now.error) {
        EXPECT_GT(now.error->size(), 10u);  // a sentence
      }
      for (const Vec3& x : now.shown->places) ASSERT_TRUE(x.allFinite());
    }
    live->pause(true);
    expect_recorded(recording());
    live->post(input::Reset{});
    static_cast<void>(recording());
    const auto now = live->now();
    EXPECT_FALSE(now.error) << *now.error;
    EXPECT_EQ(now.shown->places, first->places);
    EXPECT_EQ(now.shown->state.destroyed, first->state.destroyed);
  }

  /// What was done and not taken back, done again, leaves the same bits.
  void expect_recorded(const std::string& text) const {
    Session again(problem, make(), true, PictureSize{320, 240});
    Inputs inputs = parse_inputs(text, "recording");
    resolve(inputs, *problem);
    for (const Input& input : inputs.list) again.take(inputs, input);
    const auto there = live->now().shown;
    EXPECT_EQ(again.show(0)->places, there->places);
    EXPECT_EQ(state_of(again.simulation()).destroyed, there->state.destroyed);
  }

  std::shared_ptr<const Problem> problem;
  std::optional<Session> session;
  std::optional<LiveSession> live;
  std::shared_ptr<const Shown> first;
};

class RandomInput : public testing::TestWithParam<Route> {};

TEST_P(RandomInput, IsRecordedAndTakenBack) {
  Rounds rounds(GetParam());
  for (unsigned round = 0; round < 3 && !HasFailure(); ++round) {
    ASSERT_NO_FATAL_FAILURE(rounds.round(round));
  }
}

INSTANTIATE_TEST_SUITE_P(Routes, RandomInput, testing::Values(Route::inverse, Route::factor),
                         [](const auto& of) {
                           return of.param == Route::inverse ? "inverse" : "factor";
                         });

}  // namespace
}  // namespace sunder::test
