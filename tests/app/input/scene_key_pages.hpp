// SPDX-License-Identifier: Apache-2.0
// What is written from the table of scene keys (core/scene/scene_keys.cpp) and committed.
#pragma once

#include <string>

namespace sunder::test {

/// `page`, docs/interface.md, with its table of keys written anew. Throws std::runtime_error where
/// the page has no such table.
[[nodiscard]] std::string with_key_table(const std::string& page);

/// tests/fuzz/scene.dict.
[[nodiscard]] std::string scene_dictionary();

/// docs/tissues.md, from core/scene/tissue_presets.cpp.
[[nodiscard]] std::string tissues_page();

}  // namespace sunder::test
