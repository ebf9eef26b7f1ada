// SPDX-License-Identifier: Apache-2.0
// Where things stand in a scene's file, so that what Problem finds wrong with them is reported with
// file:line:column as well.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sunder/error.hpp"

namespace sunder::app {

struct ScenePlaces {
  std::string file;
  /// A thing as Problem's messages begin with it (`material "upper" `, `fracture.alpha `), and
  /// "file:line:column".
  std::vector<std::pair<std::string, std::string>> places;

  /// The error with the place in front of its message where the thing's place is known.
  [[nodiscard]] InputError located(const InputError& error) const;
};

}  // namespace sunder::app
