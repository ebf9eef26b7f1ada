// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <system_error>

#include "app/system/folder.hpp"
#include "app/system/handle.hpp"

namespace sunder::app::system {

/// A file in a folder that one process at a time holds. The system frees it when the process ends,
/// however it ends; the file stays then, with what was in it.
class LockFile {
 public:
  enum class Taken { yes, held_by_another, no_locks, no };

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
  /// Makes it `handle_`.
  void open(const Folder& folder, const std::string& name, std::error_code& error);
  /// `yes`, `held_by_another` or `no_locks`.
  [[nodiscard]] Taken lock(std::error_code& error) const;
  /// Whether the open file is the folder's of this name.
  [[nodiscard]] bool still_there(const Folder& folder, const std::string& name) const;

  Handle handle_;
};

}  // namespace sunder::app::system
