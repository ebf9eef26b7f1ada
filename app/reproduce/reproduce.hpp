// SPDX-License-Identifier: Apache-2.0
// The paper, reproduced: all chapters, and the files that tell them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/output/result_folder.hpp"
#include "app/reproduce/chapters.hpp"

namespace sunder::app::reproduce {

/// Runs every chapter. `tell(what, done, all)` hears how far it is. Throws Interrupted when `stop`
/// says so.
[[nodiscard]] Study carry_out_study(
    const Effort& effort, const std::string& backend, const std::function<bool()>& stop,
    const std::function<void(const std::string&, std::size_t, std::size_t)>& tell);

/// Writes index.html, reproduce.json, reproduction.md, the figures and the tables in place of what
/// an earlier run left; all appear or none, reproduce.json last. Returns their names.
std::vector<std::string> write_study(const Study& study, ResultFolder& folder);

}  // namespace sunder::app::reproduce
