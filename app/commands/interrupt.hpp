// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a flag that the run looks at between events.
#pragma once

namespace sunder::app {

/// While it lives, the first SIGINT or SIGTERM only sets a flag; a second one ends the program at
/// once, so that a computation that does not come back can be stopped.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] static bool requested();
};

}  // namespace sunder::app
