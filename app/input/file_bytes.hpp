// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace sunder::app {

/// The bytes of a regular file. Throws InputError when it is missing, a directory, something else
/// than a file, unreadable, empty, or larger than `largest` bytes.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, std::size_t largest);

}  // namespace sunder::app
