// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <fstream>
#include <string>

#include "cpu_reference/cpu_reference.hpp"
#include "machine/memory.hpp"

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

}  // namespace

DeviceInfo device() {
  DeviceInfo info;
  info.backend = "cpu";
  info.name = cpu_name();
  info.driver = eigen_version();
  info.precisions = "fp64";
  info.limits = std::to_string(machine::available_memory() / 1000000) +
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
