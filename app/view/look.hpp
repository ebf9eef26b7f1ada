// SPDX-License-Identifier: Apache-2.0
// How a body is looked at: what inputs of that kind set.
#pragma once

#include <optional>

#include "app/inputs/inputs.hpp"

namespace sunder::app {

struct Look {
  input::Camera camera;
  std::optional<Vec3> at;
  std::optional<input::Colour> colour;  ///< none: by what the scene computes (standard_field)
  input::Clip clip;
  bool wireframe = false, arrows = true, tips = true, fibres = true, text = true, pictures = true;
};

/// True: the input was about that.
bool set(Look& look, const Input& input);

/// Ratio to yield where something can break by strength, else stress; strain where the scene
/// leaves stress out.
[[nodiscard]] Field standard_field(const Problem& problem);

}  // namespace sunder::app
