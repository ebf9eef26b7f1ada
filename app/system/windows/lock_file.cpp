// SPDX-License-Identifier: Apache-2.0
#include "app/system/lock_file.hpp"

#include <utility>

#include "app/system/windows/handle.hpp"

namespace sunder::app::system {
namespace {

/// A lock keeps others from reading what it covers: this byte is far behind what stands there.
constexpr std::uint64_t kLockedByte = std::uint64_t{1} << 62U;

/// A file that was removed while others have it open can be opened by nobody until they close it.
HANDLE open_lock(const std::filesystem::path& path) {
  constexpr int kMostTries = 100;
  constexpr DWORD kMilliseconds = 10;
  HANDLE lock = INVALID_HANDLE_VALUE;
  for (int i = 0; i < kMostTries && lock == INVALID_HANDLE_VALUE; ++i) {
    if (i > 0) Sleep(kMilliseconds);
    lock = CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE, kShared | FILE_SHARE_WRITE,
                       nullptr, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, nullptr);
    if (lock == INVALID_HANDLE_VALUE && GetLastError() != ERROR_ACCESS_DENIED) break;
  }
  return lock;
}

/// The one before may have given it back, and removed the file, in between.
bool still_there(HANDLE lock) {
  FILE_STANDARD_INFO info{};
  return GetFileInformationByHandleEx(lock, FileStandardInfo, &info, sizeof info) &&
         !info.DeletePending;
}

}  // namespace

LockFile::~LockFile() { close(); }

void LockFile::close() {
  if (handle_ != -1) CloseHandle(handle_of(std::exchange(handle_, -1)));
}

LockFile::Taken LockFile::take(const Folder& folder, const std::string& name,
                               std::error_code& error) {
  for (;; close()) {
    const HANDLE lock = open_lock(folder.path_ / name);
    handle_ = kept(lock);
    error = last_error();
    if (lock == INVALID_HANDLE_VALUE) return Taken::no;
    OVERLAPPED place = at(kLockedByte);
    if (LockFileEx(lock, LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place)) {
      if (still_there(lock)) break;
    } else if (GetLastError() == ERROR_LOCK_VIOLATION || GetLastError() == ERROR_IO_PENDING) {
      return Taken::held_by_another;
    } else {
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
  for (;;) {
    OVERLAPPED place = at(text.size());
    DWORD got = 0;
    if (!ReadFile(handle_of(handle_), buffer, sizeof buffer, &got, &place) || got == 0) return text;
    text.append(buffer, got);
  }
}

void LockFile::write(std::string_view text) const {
  const HANDLE lock = handle_of(handle_);
  const LARGE_INTEGER start{};
  DWORD written = 0;
  if (!SetFilePointerEx(lock, start, nullptr, FILE_BEGIN) || !SetEndOfFile(lock)) return;
  WriteFile(lock, text.data(), static_cast<DWORD>(text.size()), &written, nullptr);
}

/// Removed first: closing gives it back, and takes it away.
void LockFile::release(const Folder& folder, const std::string& name) {
  DeleteFileW((folder.path_ / name).c_str());
  close();
}

}  // namespace sunder::app::system
