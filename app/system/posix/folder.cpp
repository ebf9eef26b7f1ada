// SPDX-License-Identifier: Apache-2.0
#include "app/system/folder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "app/system/posix/handle.hpp"

namespace sunder::app::system {

Folder::Folder(std::filesystem::path path, std::error_code& error)
    : path_(std::move(path)), handle_(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  error = handle_.is_open() ? std::error_code() : last_error();
}

File Folder::create(const std::string& name, std::error_code& error) const {
  File file(Handle(
      ::openat(descriptor(handle_), name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)));
  error = file.is_open() ? std::error_code() : last_error();
  return file;
}

void Folder::rename(const std::string& from, const std::string& to, std::error_code& error) const {
  const int here = descriptor(handle_);
  const bool done = ::renameat(here, from.c_str(), here, to.c_str()) == 0;
  error = done ? std::error_code() : last_error();
}

void Folder::remove(const std::string& name, std::error_code& error) const {
  const bool done =
      ::unlinkat(descriptor(handle_), name.c_str(), 0) == 0 || errno == ENOENT || errno == EISDIR;
  error = done ? std::error_code() : last_error();
}

void Folder::let_go() noexcept {}

void check_writable(const std::filesystem::path& folder, std::error_code& error) {
  error = ::access(folder.c_str(), W_OK | X_OK) == 0 ? std::error_code() : last_error();
}

void remove_empty_folder(const std::filesystem::path& folder, std::error_code& error) {
  error = ::rmdir(folder.c_str()) == 0 ? std::error_code() : last_error();
}

}  // namespace sunder::app::system
