// SPDX-License-Identifier: Apache-2.0
#include "machine/memory.hpp"

#if defined(_WIN32)
#include "machine/windows_api.hpp"
#else
#include <unistd.h>
#endif

#include <algorithm>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>

namespace sunder::machine {

#if defined(_WIN32)

std::size_t available_memory() {
  // Wine keeps an answer for a second, and hands it to other threads before it is there: as 0.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof(status);
  return GlobalMemoryStatusEx(&status) ? static_cast<std::size_t>(status.ullAvailPhys) : 0;
}

#else

namespace {

/// "MemAvailable:  1234 kB" of a file: its number; none: the file has no such line.
std::optional<std::size_t> number_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  std::string word;
  std::size_t value = 0;
  while (in >> word) {
    if (word == name && in >> value) return value;
  }
  return std::nullopt;
}

/// The one number in a file; none: it is not there, or is "max".
std::optional<std::size_t> number_in(const char* file) {
  std::ifstream in(file);
  std::size_t value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

}  // namespace

std::size_t available_memory() {
  std::size_t bytes = static_cast<std::size_t>(sysconf(_SC_AVPHYS_PAGES)) *
                      static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  if (const auto kilobytes = number_of("/proc/meminfo", "MemAvailable:")) bytes = *kilobytes * 1024;
  // Of a container (control groups, version 2). What of its use caches files can be had too.
  const auto limit = number_in("/sys/fs/cgroup/memory.max");
  const auto used = number_in("/sys/fs/cgroup/memory.current");
  if (!limit || !used) return bytes;
  const std::size_t cached = number_of("/sys/fs/cgroup/memory.stat", "inactive_file").value_or(0);
  const std::size_t held = *used - std::min(*used, cached);
  return std::min(bytes, *limit - std::min(*limit, held));
}

#endif

}  // namespace sunder::machine
