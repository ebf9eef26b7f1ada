// SPDX-License-Identifier: Apache-2.0
// Tissues by name, with where each number comes from: what `preset` of a material means, the page
// docs/tissues.md and the presets of the C interface.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sunder/scene.hpp"

namespace sunder {

struct SourcedValue {
  double value = 0;
  std::string_view source;  ///< author and year; "order of magnitude" where it is no more
};

struct TissuePreset {
  std::string_view name;    ///< in scenes
  std::string_view tissue;  ///< in words
  SourcedValue young, poisson;
  /// What nobody has measured is not there.
  std::optional<SourcedValue> yield, toughness, energy, density;

  [[nodiscard]] Material material() const;
};

/// By name.
[[nodiscard]] std::span<const TissuePreset> tissue_presets();

/// In the same order.
[[nodiscard]] std::vector<std::string> preset_names();

/// Null: there is none of that name.
[[nodiscard]] const TissuePreset* find_preset(std::string_view name);

}  // namespace sunder
