// SPDX-License-Identifier: Apache-2.0
// What a frame has to say beyond its numbers, kept without words: a frame makes no text.
#pragma once

#include <cstdint>
#include <string>

#include "sunder/scene.hpp"

namespace sunder {

struct Finding {
  enum class Kind : std::uint8_t {
    closing_push,      ///< instrument, crack
    nothing_to_press,  ///< instrument
    removed_before,    ///< removal, step, count
    field_fixed,       ///< crack, tip
    field_material,    ///< crack, tip
    field_damage,      ///< crack, tip
    field_strain,      ///< crack, tip
    field_notch,       ///< crack, tip
    field_coarse,      ///< crack, tip
    field_split,       ///< crack, tip
    formula_notch,     ///< crack
    formula_split,     ///< crack
    nodes_spent,
    lips_overlap,    ///< crack
    lips_unsettled,  ///< step
  };
  Kind kind;
  int subject = 0;            ///< the first of what the kind names
  int detail = 0, count = 0;  ///< the others
  friend bool operator==(const Finding&, const Finding&) = default;
};

/// The finding in words.
[[nodiscard]] std::string sentence(const Finding& finding, const Scene& scene);

}  // namespace sunder
