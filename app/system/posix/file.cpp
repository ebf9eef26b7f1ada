// SPDX-License-Identifier: Apache-2.0
#include "app/system/file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "app/system/posix/handle.hpp"

namespace sunder::app::system {
namespace {

/// `some` writes as much as the system takes at once and returns how much that was.
template <class Some>
void write_all(std::string_view bytes, std::error_code& error, const Some& some) {
  error.clear();
  while (!bytes.empty()) {
    const ssize_t written = some(bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      error = last_error();
      return;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

File::File(const std::filesystem::path& path, Keep keep, std::error_code& error) {
  const int cut = keep == Keep::nothing ? O_TRUNC : 0;
  handle_ = Handle(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | cut, 0666));
  error = is_open() ? std::error_code() : last_error();
}

void File::append(std::string_view bytes, std::error_code& error) const {
  write_all(bytes, error, [this](std::string_view rest) {
    return ::write(descriptor(handle_), rest.data(), rest.size());
  });
}

void File::write(std::uint64_t position, std::string_view bytes, std::error_code& error) const {
  write_all(bytes, error, [&](std::string_view rest) {
    const std::uint64_t at = position + (bytes.size() - rest.size());
    return ::pwrite(descriptor(handle_), rest.data(), rest.size(), static_cast<off_t>(at));
  });
}

void File::resize(std::uint64_t bytes, std::error_code& error) const {
  const bool done = ::ftruncate(descriptor(handle_), static_cast<off_t>(bytes)) == 0;
  error = done ? std::error_code() : last_error();
}

void File::close(std::error_code& error) {
  error = handle_.close() ? std::error_code() : last_error();
}

}  // namespace sunder::app::system
