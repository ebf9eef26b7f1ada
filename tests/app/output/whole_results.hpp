// SPDX-License-Identifier: Apache-2.0
// What a result folder may hold after a run, and waiting for what one holds while it goes on.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::test {

/// The name under which a process writes a file.
inline std::filesystem::path half_written(const std::filesystem::path& folder,
                                          const std::string& name, pid_t process) {
  return folder / (name + "." + std::to_string(process) + ".partial");
}

/// Waits until a file is there and, with `bytes`, has grown to that size.
inline bool wait_for(const std::filesystem::path& path, std::uintmax_t bytes = 0) {
  for (int i = 0; i < 60000; ++i) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    if (!error && size >= bytes) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// All files of one run, which fit each other, and nothing half-written.
inline void expect_whole_results(const std::filesystem::path& folder) {
  for (const std::string& name : names_in(folder)) {
    EXPECT_EQ(name.find(".partial"), std::string::npos) << name;
    EXPECT_NE(name.front(), '.') << name;
  }
  for (const char* name : {"summary.json", "events.csv", "frames.csv", "result.vtu", "figure.svg",
                           "figure.png", "index.html"})
    ASSERT_TRUE(std::filesystem::exists(folder / name)) << name;
  const auto summary = read_json(folder / "summary.json");
  EXPECT_EQ(read_csv(folder / "frames.csv").size(), summary["steps_done"].get<std::size_t>() + 1);
  EXPECT_EQ(read_csv(folder / "events.csv").size(), summary["destroyed"].size() + 1);
  EXPECT_EQ(parse_xml(read_file(folder / "result.vtu")).name, "VTKFile");
  EXPECT_EQ(parse_xml(read_file(folder / "figure.svg")).name, "svg");
}

}  // namespace sunder::test
