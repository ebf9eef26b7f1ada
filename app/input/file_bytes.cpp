// SPDX-License-Identifier: Apache-2.0
#include "app/input/file_bytes.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why,
                       InputFault fault = InputFault::unreadable_file) {
  throw InputError(fault, path.string() + ": " + why);
}

}  // namespace

std::string read_file(const std::filesystem::path& path, std::size_t largest) {
  constexpr std::size_t kLongestName = 255;  // bytes, of Linux's file systems
  for (const std::filesystem::path& part : path) {
    const std::string name = part.string();
    if (name.size() <= kLongestName) continue;
    throw InputError(InputFault::unreadable_file,
                     in_quotes(name) + ": the name has " + std::to_string(name.size()) +
                         " bytes; allowed: up to " + std::to_string(kLongestName));
  }
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path, code);
  if (status.type() == std::filesystem::file_type::not_found) fail(path, "no such file");
  if (status.type() == std::filesystem::file_type::none) fail(path, code.message());
  if (std::filesystem::is_directory(status)) fail(path, "is a directory, not a file");
  if (!std::filesystem::is_regular_file(status)) fail(path, "is not a regular file");

  const std::uintmax_t size = std::filesystem::file_size(path, code);
  if (code) fail(path, code.message());
  if (size == 0) fail(path, "the file is empty");
  if (size > largest) {
    fail(path,
         "the file has " + std::to_string(size) + " bytes; allowed: up to " +
             std::to_string(largest),
         InputFault::too_large);
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(size)))
    fail(path, std::string("cannot be read: ") + std::strerror(errno));
  return bytes;
}

}  // namespace sunder::app
