// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "app/system/folder.hpp"

namespace sunder::app::system {

/// A file in a folder that one process at a time holds. The system frees it when the process ends,
/// however it ends; the file stays then, with what was in it.
class LockFile {
 public:
  enum class Taken { yes, held_by_another, no_locks, no };

  LockFile() = default;
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;
  ~LockFile();

  /// Creates the file where it is missing. `no_locks`: the file system has none, the file is open
  /// all the same; `no`: it cannot be opened. `error` has the cause of both.
  Taken take(const Folder& folder, const std::string& name, std::error_code& error);
  /// What stands in it, also where another holds it; empty: nothing, or it cannot be read.
  [[nodiscard]] std::string read() const;
  /// Replaces what stands in it. What cannot be written (a full disk) is left out.
  void write(std::string_view text) const;
  /// Removes the file and gives it back.
  void release(const Folder& folder, const std::string& name);

 private:
  void close();

  std::intptr_t handle_ = -1;
};

}  // namespace sunder::app::system
