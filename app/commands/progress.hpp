// SPDX-License-Identifier: Apache-2.0
// How far a run is, on stderr: one line that renews itself on a terminal, a few plain lines
// elsewhere.
#pragma once

#include <chrono>
#include <string>

namespace sunder::app {

class Progress {
 public:
  /// `shown` false: silent. `counts`: what it says of the number beside the step, "destroyed";
  /// `unit`: what the steps are.
  Progress(int steps, bool shown, std::string counts, std::string unit = "step");
  ~Progress();

  /// After a step, and within one after each event (then `steps_done` has not grown).
  void update(int steps_done, int broken);
  /// Ends the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string line(int steps_done, int broken, double seconds) const;

  int steps_;
  std::string counts_, unit_;
  bool shown_, terminal_;
  bool open_ = false;  ///< a line on the terminal has no end yet
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace sunder::app
