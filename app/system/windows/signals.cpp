// SPDX-License-Identifier: Apache-2.0
#include "app/system/signals.hpp"

#include "machine/windows_api.hpp"

namespace sunder::app::system {
namespace {

/// Counts those that came and nobody looked for yet.
HANDLE waiting_ones() noexcept {
  constexpr LONG kMost = 1000;
  static const HANDLE semaphore = CreateSemaphoreW(nullptr, 0, kMost, nullptr);
  return semaphore;
}

/// On a thread of the system. Where the console closes, returning would end the program.
BOOL WINAPI take(DWORD event) {
  ReleaseSemaphore(waiting_ones(), 1, nullptr);
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) Sleep(INFINITE);
  return TRUE;
}

}  // namespace

void hold_signals() noexcept {
  static const BOOL held = SetConsoleCtrlHandler(take, TRUE);
  static_cast<void>(held);
}

bool await_signal(std::chrono::milliseconds limit) noexcept {
  const DWORD time = limit.count() > 0 ? static_cast<DWORD>(limit.count()) : INFINITE;
  return WaitForSingleObject(waiting_ones(), time) == WAIT_OBJECT_0;
}

void wake(std::thread&) noexcept { ReleaseSemaphore(waiting_ones(), 1, nullptr); }

}  // namespace sunder::app::system
