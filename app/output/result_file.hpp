// SPDX-License-Identifier: Apache-2.0
// A result file appears under its name complete or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sunder/error.hpp"

namespace sunder::app {

/// A result file could not be written (disk full, no permission): exit code 1.
class OutputError : public Error {
 public:
  explicit OutputError(const std::string& message) : Error(1, message) {}
};

/// Writes to a temporary name in the same folder; commit() gives the file its name, a file that
/// was not committed is removed. Throws OutputError, which names the file and the cause.
class ResultFile {
 public:
  explicit ResultFile(std::filesystem::path path);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void write(std::string_view text);
  /// Hands everything written so far to the system.
  void flush();
  void commit();

 private:
  [[noreturn]] void fail(const char* doing);

  std::filesystem::path path_, temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file.
void write_file(const std::filesystem::path& path, std::string_view text);

/// Makes the folder for results and checks that files can be created in it. Throws UsageError,
/// since the folder is what the user asked for with --out.
void make_result_folder(const std::filesystem::path& folder);

/// Removes what an earlier run left in the folder under the names of result files, so that results
/// of two runs never lie side by side. Other files stay.
void remove_old_results(const std::filesystem::path& folder);

}  // namespace sunder::app
