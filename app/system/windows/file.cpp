// SPDX-License-Identifier: Apache-2.0
#include "app/system/file.hpp"

#include <algorithm>

#include "app/system/windows/handle.hpp"

namespace sunder::app::system {
namespace {

/// From a position on, which is then behind what was written; null: where the file stands.
void write_all(HANDLE file, std::string_view bytes, std::uint64_t* position,
               std::error_code& error) {
  constexpr std::size_t kMost = std::size_t{1} << 30U;  // a call takes 32 bits
  error.clear();
  while (!bytes.empty()) {
    OVERLAPPED place = at(position ? *position : 0);
    DWORD written = 0;
    if (!WriteFile(file, bytes.data(), static_cast<DWORD>(std::min(bytes.size(), kMost)), &written,
                   position ? &place : nullptr)) {
      error = last_error();
      return;
    }
    bytes.remove_prefix(written);
    if (position) *position += written;
  }
}

}  // namespace

File::File(const std::filesystem::path& path, Keep keep, std::error_code& error) {
  const DWORD how = keep == Keep::nothing ? CREATE_ALWAYS : OPEN_ALWAYS;
  handle_ = kept(CreateFileW(path.c_str(), GENERIC_WRITE, kShared, nullptr, how,
                             FILE_ATTRIBUTE_NORMAL, nullptr));
  error = is_open() ? std::error_code() : last_error();
}

void File::append(std::string_view bytes, std::error_code& error) const {
  write_all(handle_of(handle_), bytes, nullptr, error);
}

void File::write(std::uint64_t position, std::string_view bytes, std::error_code& error) const {
  write_all(handle_of(handle_), bytes, &position, error);
}

void File::resize(std::uint64_t bytes, std::error_code& error) const {
  LARGE_INTEGER end{};
  end.QuadPart = static_cast<LONGLONG>(bytes);
  const HANDLE file = handle_of(handle_);
  const bool done = SetFilePointerEx(file, end, nullptr, FILE_BEGIN) && SetEndOfFile(file);
  error = done ? std::error_code() : last_error();
}

void File::close(std::error_code& error) {
  error = handle_.close() ? std::error_code() : last_error();
}

}  // namespace sunder::app::system
