// SPDX-License-Identifier: Apache-2.0
// What asks a program to end: SIGINT and SIGTERM; on Windows Ctrl-C, Ctrl-Break and the closing of
// its console.
#pragma once

#include <chrono>
#include <thread>

namespace sunder::app::system {

/// Holds them back from this thread and from all that it starts: those that come wait until
/// somebody looks for them.
void hold_signals() noexcept;
/// Waits for one; false when the time is over first. Zero: without end.
[[nodiscard]] bool await_signal(std::chrono::milliseconds limit) noexcept;
/// Ends the waiting of a thread as a signal would.
void wake(std::thread& waiting) noexcept;

}  // namespace sunder::app::system
