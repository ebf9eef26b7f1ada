// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "app/system/file.hpp"
#include "app/system/handle.hpp"

namespace sunder::app::system {

/// A folder held open: of one that is renamed or removed meanwhile nothing lands in another of its
/// name. On Windows it cannot be renamed or removed while it is held.
class Folder {
 public:
  /// None.
  Folder() = default;
  /// `error`: why it is not open.
  Folder(std::filesystem::path path, std::error_code& error);

  /// A new or emptied file in it.
  [[nodiscard]] File create(const std::string& name, std::error_code& error) const;
  /// Replaces a file of the new name at once.
  void rename(const std::string& from, const std::string& to, std::error_code& error) const;
  /// No error where there is no such file, or a folder of this name.
  void remove(const std::string& name, std::error_code& error) const;
  /// From here on it may be renamed and removed, and on Windows nothing more be done in it.
  void let_go() noexcept;

 private:
  friend class LockFile;
  std::filesystem::path path_;
  Handle handle_;
};

/// Whether files can be created in a folder; `error`: why not. Windows tells at the first file.
void check_writable(const std::filesystem::path& folder, std::error_code& error);

/// `error`: why it is still there, say because something lies in it.
void remove_empty_folder(const std::filesystem::path& folder, std::error_code& error);

}  // namespace sunder::app::system
