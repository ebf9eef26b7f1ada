// SPDX-License-Identifier: Apache-2.0
// What the tests of bad input share: a scene that is right, files for a moment, one assertion.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "sunder/error.hpp"

namespace sunder::test {

/// A folder that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sunder-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// `text` with the first `from` replaced; `from` must be there, so that no case tests nothing.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the base text has no \"" << from << '"';
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Runs `read`, which must throw an InputError of this fault (exit code 3) whose message is one
/// line and contains every part.
inline void expect_input_error(const std::function<void()>& read, InputFault fault,
                               const std::vector<std::string>& parts) {
  try {
    read();
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.exit_code(), 3);
    EXPECT_EQ(static_cast<int>(error.fault()), static_cast<int>(fault)) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 700U) << message;
    for (const std::string& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "no \"" << part << "\" in: " << message;
  } catch (const std::exception& error) {
    FAIL() << "another exception: " << error.what();
  }
}

/// Every section and nearly every key of the schema; line 1 is the title.
inline std::string good_scene() {
  return R"(title = "A scene that is right"
mesh = "board.msh"

[material.bottom-frame]
young = 500.0
poisson = 0.4
[material.lower]
young = 8.0
poisson = 0.4
yield = 4.0
[material.upper]
young = 5
poisson = 0.4
yield = 2.0
[material.top-frame]
young = 500.0
poisson = 0.4

[[fixed]]
box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]
axes = "xyz"

[[instrument]]
name = "right forceps"
kind = "expansion"
box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]
force = [0.0, -60.0, 0.0]
ramp = [0.0, 1.0]

[[instrument]]
name = "left forceps"
kind = "expansion"
near = [0.0, 0.0, 0.0]
radius = 0.5
displacement = [0.0, -1.0, 0.0]
axes = "y"

[[instrument]]
name = "probe"
kind = "pressure"
at = [48.0, 25.0, 1.0]
side = "upper"
crack = 0
force = [0.0, 5.0, 0.0]

[[crack]]
elements = [60, 61]
mouth = [50.0, 25.0, 1.0]
tip = [46.0, 25.0, 1.0]

[[destroy]]
step = 3
elements = [1, 2]

[fracture]
model = "B"
alpha = 1e-6
yield_measure = "max_shear"
sigma0 = "line"
crack_length = "path"
sif = "formula"
max_events = 10000
plane_normal = [0, 0, 1]

[solver]
backend = "auto"
route = "auto"
update = "auto"
precision = "auto"
tolerance = 1e-4

[time]
steps = 4
[output]
fields = ["displacement", "stress"]
)";
}

}  // namespace sunder::test
