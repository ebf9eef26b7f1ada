// SPDX-License-Identifier: Apache-2.0
#include "app/system/lock_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "app/system/posix/last_error.hpp"

namespace sunder::app::system {
namespace {

int open_lock(int folder, const char* name) {
  const int lock = ::openat(folder, name, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (lock >= 0 || errno != EACCES) return lock;
  // Left by another user's run that was killed.
  return ::openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
}

/// The one before may have given it back, and removed the file, in between.
bool still_there(int lock, int folder, const char* name) {
  struct stat mine {
  }, there{};
  return ::fstat(lock, &mine) == 0 && ::fstatat(folder, name, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

}  // namespace

LockFile::~LockFile() { close(); }

void LockFile::close() {
  if (handle_ >= 0) ::close(static_cast<int>(std::exchange(handle_, -1)));
}

LockFile::Taken LockFile::take(const Folder& folder, const std::string& name,
                               std::error_code& error) {
  const int place = static_cast<int>(folder.handle_);
  for (;; close()) {
    const int lock = open_lock(place, name.c_str());
    handle_ = lock;
    error = last_error();
    if (lock < 0) return Taken::no;
    if (::flock(lock, LOCK_EX | LOCK_NB) == 0) {
      if (still_there(lock, place, name.c_str())) break;
    } else if (errno == EWOULDBLOCK) {
      return Taken::held_by_another;
    } else if (errno != EINTR) {
      error = last_error();
      return Taken::no_locks;
    }
  }
  error.clear();
  return Taken::yes;
}

std::string LockFile::read() const {
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0; (got = ::pread(static_cast<int>(handle_), buffer, sizeof buffer,
                                       static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

void LockFile::write(std::string_view text) const {
  const int lock = static_cast<int>(handle_);
  if (::ftruncate(lock, 0) != 0) return;
  if (::pwrite(lock, text.data(), text.size(), 0) < 0) return;
}

void LockFile::release(const Folder& folder, const std::string& name) {
  ::unlinkat(static_cast<int>(folder.handle_), name.c_str(), 0);
  ::flock(static_cast<int>(handle_), LOCK_UN);
}

}  // namespace sunder::app::system
