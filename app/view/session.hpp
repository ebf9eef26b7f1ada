// SPDX-License-Identifier: Apache-2.0
// A body that is looked at: its simulation, what is done to it, and how it is seen. It may be
// changed, or another one opened in its place, while it is looked at.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/view/body.hpp"
#include "app/view/camera.hpp"
#include "app/view/carry_over.hpp"
#include "app/view/look.hpp"

namespace sunder::app {

class Session {
 public:
  /// `make`: the backend, once and, `goes_back`, whenever going back takes a new one. `points`: as
  /// BodyPlan has them.
  Session(const std::shared_ptr<const Problem>& problem, const Simulation::MakeBackend& make,
          bool goes_back, const PictureSize& size,
          std::shared_ptr<view::SharedPoints> points = nullptr);

  /// From here on its scene can be changed and others opened (input::Set, input::Open).
  void can_change(Origin origin, PlanBody plan);

  /// Does an input but for its pictures: those of a frame are the caller's. Throws InputError with
  /// the input's place for one that cannot be done now, NumericalError from a step. Where a body
  /// cannot be changed or opened, whatever the error, the one that is there stays as it is.
  void take(const Inputs& inputs, const Input& input);
  /// A step, if there is one left.
  void step() { body_->step(); }
  /// A step unless paused.
  void advance();
  /// The device that draws was lost, and there is another one: a simulation on it begins anew there
  /// and does again what was done, to the same bits. Any other stays. Throws what
  /// Simulation::renew_backend throws.
  void renew();

  [[nodiscard]] const Simulation& simulation() const { return body_->simulation; }
  [[nodiscard]] Simulation& simulation() { return body_->simulation; }
  [[nodiscard]] const Problem& problem() const { return simulation().problem(); }
  [[nodiscard]] Hand& hand() { return body_->hand; }
  [[nodiscard]] const Hand& hand() const { return body_->hand; }
  [[nodiscard]] Look& look() { return look_; }
  [[nodiscard]] const Look& look() const { return look_; }
  [[nodiscard]] bool paused() const { return paused_; }
  void pause(bool on) { paused_ = on; }
  [[nodiscard]] Camera camera() const;
  /// Of the last step, as far back as one has gone; null before the first.
  [[nodiscard]] const StepReport* report() const { return body_->report(); }
  /// What a picture says of now; no time, so that the same state has the same words.
  [[nodiscard]] FrameWords words() const;
  /// Now, to be drawn (Showing::show).
  [[nodiscard]] std::shared_ptr<const Shown> show(std::uint64_t since);

  /// Of the body that is there. Which one it is: 0, and one more with each change.
  [[nodiscard]] const Origin& origin() const { return origin_; }
  [[nodiscard]] int body() const { return number_; }
  /// What became of the last change or opening: a sentence, with what it took; empty: there was
  /// none.
  [[nodiscard]] const std::string& said() const { return said_; }
  /// Grips that the last change has taken along: their numbers now by those before.
  [[nodiscard]] const std::map<int, int>& carried() const { return carried_; }

 private:
  void go_back(const Inputs& inputs, const Input& input);
  void change(const std::vector<std::string>& changes);
  void open(const std::string& file);
  [[nodiscard]] std::unique_ptr<Body> prepared(const Origin& origin) const;
  void take_on(std::unique_ptr<Body> body, Origin origin);

  const bool goes_back_;
  std::unique_ptr<Body> body_;
  Origin origin_;
  PlanBody plan_;  ///< none: it stays as it is
  int number_ = 0;
  std::map<int, int> carried_;
  std::string said_;
  Look look_;
  PictureSize size_;
  bool paused_ = false;
};

/// What has broken, and why: "element 12 is gone (mss, ratio 1.02)".
[[nodiscard]] std::string sentence_of(const DestroyedElement& row);

}  // namespace sunder::app
