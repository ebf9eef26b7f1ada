// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

#include "cpu_reference/available_memory.hpp"
#include "cpu_reference/cpu_reference.hpp"

namespace sunder::cpu_reference {
namespace {

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "CPU";
}

std::string eigen_version() {
  return "Eigen " + std::to_string(EIGEN_WORLD_VERSION) + "." +
         std::to_string(EIGEN_MAJOR_VERSION) + "." + std::to_string(EIGEN_MINOR_VERSION);
}

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

DeviceInfo device() {
  DeviceInfo info;
  info.backend = "cpu";
  info.name = cpu_name();
  info.driver = eigen_version();
  info.precisions = "fp64";
  info.limits = std::to_string(available_memory() / 1000000) +
                " MB free memory, routes inverse, condensed, factor, cg";
  info.chosen = true;
  info.why = "always available";
  return info;
}

BackendInfo info_of_device() {
  const DeviceInfo cpu = device();
  BackendInfo info;
  info.backend = cpu.backend;
  info.device = cpu.name;
  info.driver = cpu.driver;
  info.precision = cpu.precisions;
  return info;
}

}  // namespace sunder::cpu_reference
