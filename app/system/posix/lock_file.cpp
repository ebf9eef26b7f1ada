// SPDX-License-Identifier: Apache-2.0
#include "app/system/lock_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "app/system/posix/handle.hpp"

namespace sunder::app::system {
void LockFile::open(const Folder& folder, const std::string& name, std::error_code& error) {
  const int place = descriptor(folder.handle_);
  int lock = ::openat(place, name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  // Left by another user's run that was killed.
  if (lock < 0 && errno == EACCES) {
    lock = ::openat(place, name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  }
  error = last_error();
  handle_ = Handle(lock);
}

LockFile::Taken LockFile::lock(std::error_code& error) const {
  error.clear();
  while (::flock(descriptor(handle_), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return Taken::held_by_another;
    if (errno == EINTR) continue;
    error = last_error();
    return Taken::no_locks;
  }
  return Taken::yes;
}

bool LockFile::still_there(const Folder& folder, const std::string& name) const {
  struct stat mine {
  }, there{};
  return ::fstat(descriptor(handle_), &mine) == 0 &&
         ::fstatat(descriptor(folder.handle_), name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

std::string LockFile::read() const {
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0; (got = ::pread(descriptor(handle_), buffer, sizeof buffer,
                                       static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  return text;
}

void LockFile::write(std::string_view text) const {
  const int lock = descriptor(handle_);
  if (::ftruncate(lock, 0) != 0) return;
  if (::pwrite(lock, text.data(), text.size(), 0) < 0) return;
}

void LockFile::release(const Folder& folder, const std::string& name) {
  ::unlinkat(descriptor(folder.handle_), name.c_str(), 0);
  ::flock(descriptor(handle_), LOCK_UN);
}

}  // namespace sunder::app::system
