// SPDX-License-Identifier: Apache-2.0
// A result file appears under its name complete or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "app/system/file.hpp"
#include "sunder/error.hpp"

namespace sunder::app {

class ResultFolder;

/// A result file could not be written (disk full, no permission): exit code 1.
class OutputError : public Error {
 public:
  explicit OutputError(const std::string& message) : Error(1, message) {}
};

/// The name, of this process alone, under which a file is written before it gets its own.
[[nodiscard]] std::string temporary_name(const std::string& name);

/// Writes to a temporary name in the same folder; commit() gives the file its name, a file that
/// was not committed is removed. Throws OutputError, which names the file and the cause.
class ResultFile {
 public:
  /// A file by itself.
  explicit ResultFile(std::filesystem::path path);
  /// One of a run's.
  ResultFile(ResultFolder& folder, const std::string& name);
  ~ResultFile();
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void write(std::string_view text);
  /// Hands everything written so far to the system.
  void flush();
  void commit();

 private:
  void open();
  void remove() const;
  [[noreturn]] void fail(const char* doing, const std::error_code& error) const;

  std::filesystem::path path_;
  ResultFolder* folder_ = nullptr;
  std::string name_, temporary_;  // in folder_, or paths
  std::string buffer_;
  system::File file_;
};

/// Writes a whole file.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace sunder::app
