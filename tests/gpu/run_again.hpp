// SPDX-License-Identifier: Apache-2.0
// The present test program in a process of its own: with other variables, for tests that are
// disabled otherwise.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace sunder::test {

/// Output and exit code.
inline std::pair<std::string, int> run_again(const std::string& variables,
                                             const std::string& filter) {
  std::array<char, 4096> path{};
  EXPECT_GT(readlink("/proc/self/exe", path.data(), path.size() - 1), 0);
  const std::string command = variables + " '" + path.data() +
                              "' --gtest_also_run_disabled_tests --gtest_filter='" + filter +
                              "' 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
  const int status = pclose(pipe);
  return {output, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

/// Variables of a process that finds no Vulkan driver.
inline const char* const kNoDriver = "VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent";

}  // namespace sunder::test
