// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "app/input/scene_toml.hpp"

namespace sunder::test {

inline Scene parse(const std::string& text) { return app::parse_scene(text, "scene.toml").scene; }

}  // namespace sunder::test
