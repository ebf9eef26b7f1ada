// SPDX-License-Identifier: Apache-2.0
#include "app/commands/progress.hpp"

#include <cstdio>
#include <utility>

#include "app/output/text.hpp"
#include "app/system/process.hpp"

namespace sunder::app {
namespace {

constexpr double kTerminalSeconds = 0.1, kPlainSeconds = 5;  // between two updates

double seconds_between(auto a, auto b) { return std::chrono::duration<double>(b - a).count(); }

}  // namespace

Progress::Progress(int steps, bool shown, std::string counts, std::string unit)
    : steps_(steps),
      counts_(std::move(counts)),
      unit_(std::move(unit)),
      shown_(shown),
      terminal_(system::error_is_terminal()) {}

Progress::~Progress() { finish(); }

std::string Progress::line(int steps_done, int broken, double seconds) const {
  std::string text = unit_ + " " + std::to_string(steps_done) + "/" + std::to_string(steps_) +
                     ", " + std::to_string(broken) + " " + counts_;
  if (steps_done == 0 || !(seconds > 0)) return text;
  const double rate = steps_done / seconds;
  return text + ", " + rounded(rate, 3) + " " + unit_ + "s/s, " +
         rounded((steps_ - steps_done) / rate, 2) + " s left";
}

void Progress::update(int steps_done, int broken) {
  if (!shown_) return;
  const auto now = Clock::now();
  if (seconds_between(last_, now) < (terminal_ ? kTerminalSeconds : kPlainSeconds)) return;
  last_ = now;
  const std::string text = line(steps_done, broken, seconds_between(start_, now));
  // "\033[K" clears what a longer line before left behind.
  std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", text.c_str());
  std::fflush(stderr);
  open_ = terminal_;
}

void Progress::finish() {
  if (open_) std::fputs("\r\033[K", stderr);
  open_ = false;
}

}  // namespace sunder::app
