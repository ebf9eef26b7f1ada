// SPDX-License-Identifier: Apache-2.0
#include "app/system/folder.hpp"

#include <string>
#include <utility>

#include "app/system/windows/handle.hpp"

namespace sunder::app::system {

Folder::Folder(std::filesystem::path path, std::error_code& error)
    : path_(std::move(path)),
      // Not shared for deletion, which a new name is as well.
      handle_(
          kept(CreateFileW(path_.c_str(), FILE_LIST_DIRECTORY, FILE_SHARE_READ | FILE_SHARE_WRITE,
                           nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr))) {
  error = handle_.is_open() ? std::error_code() : last_error();
}

File Folder::create(const std::string& name, std::error_code& error) const {
  return {path_ / name, File::Keep::nothing, error};
}

void Folder::rename(const std::string& from, const std::string& to, std::error_code& error) const {
  const bool done = MoveFileExW((path_ / from).c_str(), (path_ / to).c_str(),
                                MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH) != 0;
  error = done ? std::error_code() : last_error();
}

void Folder::remove(const std::string& name, std::error_code& error) const {
  const std::filesystem::path file = path_ / name;
  const bool done = DeleteFileW(file.c_str()) || GetLastError() == ERROR_FILE_NOT_FOUND ||
                    std::filesystem::is_directory(file, error);
  error = done ? std::error_code() : last_error();
}

void Folder::let_go() noexcept { handle_.close(); }

void check_writable(const std::filesystem::path&, std::error_code& error) { error.clear(); }

void remove_empty_folder(const std::filesystem::path& folder, std::error_code& error) {
  error = RemoveDirectoryW(folder.c_str()) ? std::error_code() : last_error();
}

}  // namespace sunder::app::system
