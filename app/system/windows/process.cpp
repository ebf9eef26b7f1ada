// SPDX-License-Identifier: Apache-2.0
#include "app/system/process.hpp"

#include <algorithm>
#include <filesystem>

#include "machine/windows_api.hpp"

// After windows.h, on which they rest.
#include <shellapi.h>
#include <tlhelp32.h>

namespace sunder::app::system {
namespace {

double seconds(const FILETIME& time) {
  constexpr double kTick = 1e-7, kHigh = 4294967296.0;
  return kTick * (time.dwHighDateTime * kHigh + time.dwLowDateTime);
}

}  // namespace

/// The words that main gets are in a code page that has not all names of files.
std::vector<std::string> start_process(int, const char* const*) {
  SetConsoleOutputCP(CP_UTF8);
  int count = 0;
  wchar_t** const wide = CommandLineToArgvW(GetCommandLineW(), &count);
  std::vector<std::string> words;
  for (int i = 0; i < count; ++i) {
    const auto utf8 = std::filesystem::path(wide[i]).u8string();
    words.emplace_back(utf8.begin(), utf8.end());
  }
  LocalFree(wide);
  return words;
}

long process_id() noexcept { return static_cast<long>(GetCurrentProcessId()); }

double processor_seconds() noexcept {
  FILETIME created{}, ended{}, kernel{}, user{};
  if (!GetProcessTimes(GetCurrentProcess(), &created, &ended, &kernel, &user)) return 0;
  return seconds(kernel) + seconds(user);
}

bool error_is_terminal() noexcept {
  const HANDLE error = GetStdHandle(STD_ERROR_HANDLE);
  DWORD mode = 0;
  return GetConsoleMode(error, &mode) &&
         SetConsoleMode(error, mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
}

void write_error(std::string_view text) noexcept {
  DWORD written = 0;
  WriteFile(GetStdHandle(STD_ERROR_HANDLE), text.data(), static_cast<DWORD>(text.size()), &written,
            nullptr);
}

long thread_id() noexcept { return static_cast<long>(GetCurrentThreadId()); }

void lower_priority_of_others(const std::vector<long>& kept) noexcept {
  const HANDLE all = CreateToolhelp32Snapshot(TH32CS_SNAPTHREAD, 0);
  if (all == INVALID_HANDLE_VALUE) return;
  THREADENTRY32 entry{};
  entry.dwSize = sizeof entry;
  for (BOOL more = Thread32First(all, &entry); more; more = Thread32Next(all, &entry)) {
    if (entry.th32OwnerProcessID != GetCurrentProcessId()) continue;
    const long id = static_cast<long>(entry.th32ThreadID);
    if (std::find(kept.begin(), kept.end(), id) != kept.end()) continue;
    if (const HANDLE thread = OpenThread(THREAD_SET_INFORMATION, FALSE, entry.th32ThreadID)) {
      SetThreadPriority(thread, THREAD_PRIORITY_LOWEST);
      CloseHandle(thread);
    }
  }
  CloseHandle(all);
}

void stay() noexcept {
  for (;;) Sleep(INFINITE);
}

}  // namespace sunder::app::system
