// SPDX-License-Identifier: Apache-2.0
// --set key.path=value on a parsed scene.
#pragma once

#include <string>

#include "app/input/toml.hpp"

namespace sunder::app {

/// Sets or adds the value that `text` ("key.path=value") names. Path segments are separated by
/// dots, may be quoted, and are indices (0-based, the array's length appends) inside arrays. The
/// value is TOML; what is not TOML and starts like a word is taken as a string. The node's source
/// path becomes "--set <text>", so that later messages name it; or another `option`, which begins
/// with "--". Throws InputError.
void apply_override(toml::table& scene, const std::string& text,
                    const std::string& option = "--set");

}  // namespace sunder::app
