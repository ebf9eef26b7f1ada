// SPDX-License-Identifier: Apache-2.0
#include "app/system/lock_file.hpp"

#include "app/system/windows/handle.hpp"

namespace sunder::app::system {
namespace {

/// A lock keeps others from reading what it covers: this byte is far behind what stands there.
constexpr std::uint64_t kLockedByte = std::uint64_t{1} << 62U;

}  // namespace

/// A file that was removed while others have it open can be opened by nobody until they close it.
void LockFile::open(const Folder& folder, const std::string& name, std::error_code& error) {
  constexpr int kMostTries = 100;
  constexpr DWORD kMilliseconds = 10;
  const std::filesystem::path path = folder.path_ / name;
  for (int i = 0; i < kMostTries; ++i) {
    if (i > 0) Sleep(kMilliseconds);
    handle_ =
        kept(CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE, kShared | FILE_SHARE_WRITE,
                         nullptr, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, nullptr));
    error = last_error();
    if (handle_.is_open() || GetLastError() != ERROR_ACCESS_DENIED) return;
  }
}

LockFile::Taken LockFile::lock(std::error_code& error) const {
  error.clear();
  constexpr DWORD kOrFail = LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY;
  OVERLAPPED place = at(kLockedByte);
  if (LockFileEx(handle_of(handle_), kOrFail, 0, 1, 0, &place)) return Taken::yes;
  if (GetLastError() == ERROR_LOCK_VIOLATION || GetLastError() == ERROR_IO_PENDING) {
    return Taken::held_by_another;
  }
  error = last_error();
  return Taken::no_locks;
}

bool LockFile::still_there(const Folder&, const std::string&) const {
  FILE_STANDARD_INFO info{};
  return GetFileInformationByHandleEx(handle_of(handle_), FileStandardInfo, &info, sizeof info) &&
         !info.DeletePending;
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
  handle_.close();
}

}  // namespace sunder::app::system
