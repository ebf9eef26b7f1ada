// SPDX-License-Identifier: Apache-2.0
#include "app/system/process.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <string>

namespace sunder::app::system {

std::vector<std::string> start_process(int argc, const char* const* argv) {
  std::signal(SIGXFSZ, SIG_IGN);
  return {argv, argv + argc};
}

long process_id() noexcept { return ::getpid(); }

double processor_seconds() noexcept {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bool error_is_terminal() noexcept { return ::isatty(STDERR_FILENO) == 1; }

void write_error(std::string_view text) noexcept {
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;  // nobody is left to tell
}

long thread_id() noexcept { return ::gettid(); }

/// Not to the end of the queue: the last thread that ends gives the process's memory back, which
/// takes ten seconds at the lowest priority on a busy machine.
void lower_priority_of_others(const std::vector<long>& kept) noexcept {
  constexpr int kLower = 5;
  const int priority = ::getpriority(PRIO_PROCESS, 0) + kLower;
  std::error_code none;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", none)) {
    const long id = std::stol(task.path().filename().string());
    if (std::find(kept.begin(), kept.end(), id) != kept.end()) continue;
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(id), priority);
  }
}

void stay() noexcept {
  for (;;) ::pause();
}

}  // namespace sunder::app::system
