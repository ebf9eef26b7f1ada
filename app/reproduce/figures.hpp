// SPDX-License-Identifier: Apache-2.0
// Several states in one picture, as the paper's figures have them: a row per model, a column per
// number of fractures or per instrument.
#pragma once

#include <string>
#include <vector>

#include "app/reproduce/laboratory.hpp"

namespace sunder::app::reproduce {

struct Panel {
  const RunResult* run = nullptr;  ///< null: an empty place
  const State* state = nullptr;
  std::string title;
};

struct PanelRow {
  std::string title;
  std::vector<Panel> panels;
};

/// All panels in one scale, a colour bar and a legend below.
[[nodiscard]] std::string montage(const std::string& title, const std::vector<PanelRow>& rows);

}  // namespace sunder::app::reproduce
