// SPDX-License-Identifier: Apache-2.0
// A body that is looked at: its simulation, what is done to it, and how it is seen.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/inputs/hand.hpp"
#include "app/view/camera.hpp"
#include "app/view/look.hpp"
#include "app/view/shown.hpp"

namespace sunder::app {

class Session {
 public:
  /// `make`: the backend, once and, `goes_back`, whenever going back takes a new one.
  Session(std::shared_ptr<const Problem> problem, Simulation::MakeBackend make, bool goes_back,
          const PictureSize& size);

  /// Does an input but for its pictures: those of a frame are the caller's. Throws InputError with
  /// the input's place for one that cannot be done now, NumericalError from a step.
  void take(const Inputs& inputs, const Input& input);
  /// A step, if there is one left.
  void step();
  /// A step unless paused.
  void advance();

  [[nodiscard]] const Simulation& simulation() const { return simulation_; }
  [[nodiscard]] Simulation& simulation() { return simulation_; }
  [[nodiscard]] const Problem& problem() const { return simulation_.problem(); }
  [[nodiscard]] Hand& hand() { return hand_; }
  [[nodiscard]] const Hand& hand() const { return hand_; }
  [[nodiscard]] Look& look() { return look_; }
  [[nodiscard]] const Look& look() const { return look_; }
  [[nodiscard]] bool paused() const { return paused_; }
  void pause(bool on) { paused_ = on; }
  [[nodiscard]] Camera camera() const;
  /// Of the last step, as far back as one has gone; null before the first.
  [[nodiscard]] const StepReport* report() const;
  /// What a picture says of now; no time, so that the same state has the same words.
  [[nodiscard]] FrameWords words() const;
  /// Now, to be drawn (Showing::show).
  [[nodiscard]] std::shared_ptr<const Shown> show(std::uint64_t since);

 private:
  void go_back(const Inputs& inputs, const Input& input);

  Simulation simulation_;
  Hand hand_;
  Look look_;
  std::vector<Vec3> shown_;
  PictureSize size_;
  bool paused_ = false;
  std::vector<StepReport> reports_;  ///< by step
  Showing showing_;
};

/// What has broken, and why: "element 12 is gone (mss, ratio 1.02)".
[[nodiscard]] std::string sentence_of(const DestroyedElement& row);

}  // namespace sunder::app
