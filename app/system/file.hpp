// SPDX-License-Identifier: Apache-2.0
// A file as the system writes it: what a write could not take is said at once, and by its cause.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/system/handle.hpp"

namespace sunder::app::system {

/// Open for writing; closed with the object. One thread at a time.
class File {
 public:
  enum class Keep { nothing, contents };

  /// None.
  File() = default;
  /// Creates the file where it is missing. `error`: why it is not open.
  File(const std::filesystem::path& path, Keep keep, std::error_code& error);

  [[nodiscard]] bool is_open() const noexcept { return handle_.is_open(); }
  /// All bytes, behind those appended before. After an error a part of them may be there.
  void append(std::string_view bytes, std::error_code& error) const;
  /// The same from `position` on, which only a file has that is not a pipe.
  void write(std::uint64_t position, std::string_view bytes, std::error_code& error) const;
  void resize(std::uint64_t bytes, std::error_code& error) const;
  /// May tell what a write could only queue. The file is closed in any case.
  void close(std::error_code& error);

 private:
  friend class Folder;
  explicit File(Handle handle) : handle_(std::move(handle)) {}

  Handle handle_;
};

}  // namespace sunder::app::system
