// SPDX-License-Identifier: Apache-2.0
// sweep.rows: a line for each run that is done, in the order in which they ended. A line counts
// once it has its end, so that a process that is killed or a disk that is full costs no other run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "app/sweep/axes.hpp"
#include "app/system/file.hpp"

namespace sunder::app::sweep {

/// By run.
using Rows = std::map<RunIndex, std::string>;

/// Whole lines of a folder's file, as many cells each; none where there is no file.
[[nodiscard]] Rows read_rows(const std::filesystem::path& folder, std::size_t cells);

class RowFile {
 public:
  /// Opens it to go on behind its last whole line; `anew`: empties it. Throws OutputError.
  RowFile(const std::filesystem::path& folder, bool anew);

  /// Hands the line to the system. Throws OutputError; no half of it stays then.
  void append(const std::string& row);

 private:
  std::filesystem::path path_;
  system::File file_;
  std::uint64_t size_ = 0;
};

}  // namespace sunder::app::sweep
