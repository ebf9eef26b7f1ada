// SPDX-License-Identifier: Apache-2.0
// Runs the real program and looks at what it leaves behind.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sunder::test {

/// A folder that is removed at the end.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int exit_code = -1;  ///< minus the signal number when a signal ended it
  std::string out, err;
  double processor_seconds = 0;  ///< of all its threads
};

struct RunControl {
  std::size_t file_size_limit = 0;       ///< bytes; 0: none
  std::function<void(pid_t)> meanwhile;  ///< called once it runs
  std::string standard_output;           ///< file to write to instead of a pipe
  bool one_processor = false;            ///< all its threads share one
};

[[nodiscard]] Outcome run_program(const std::vector<std::string>& arguments,
                                  const RunControl& control = {});

[[nodiscard]] std::string read_file(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);
[[nodiscard]] nlohmann::ordered_json read_json(const std::filesystem::path& path);
/// Rows of cells, the header first.
[[nodiscard]] std::vector<std::vector<std::string>> read_csv(const std::filesystem::path& path);
/// File names in a folder, sorted.
[[nodiscard]] std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Head of a scene: the board of board.msh beside it, pulled at the lower right corner.
[[nodiscard]] std::string board_toml(const std::string& title);

/// The scene that most tests use: a structured board of 500 tetrahedra (242 nodes), pulled at the
/// lower right corner under model B until it tears.
struct TearingBoard {
  explicit TearingBoard(const TempFolder& folder);
  std::filesystem::path scene;
};

/// Runs it once per test program with --series and --snapshots 3,10,9000 and returns its folder.
[[nodiscard]] const std::filesystem::path& torn_board();
[[nodiscard]] const Outcome& torn_board_outcome();

}  // namespace sunder::test
