// SPDX-License-Identifier: Apache-2.0
// The paper, reproduced: all chapters, and the files that tell them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/reproduce/chapters.hpp"

namespace sunder::app::reproduce {

/// Runs every chapter. `tell(what, done, all)` hears how far it is. Throws Interrupted when `stop`
/// says so.
[[nodiscard]] Study carry_out_study(
    const Effort& effort, const std::string& backend, const std::function<bool()>& stop,
    const std::function<void(const std::string&, std::size_t, std::size_t)>& tell);

/// Writes index.html, reproduce.json, reproduction.md, the figures and the tables; each appears
/// complete or not at all, reproduce.json last. Returns their names.
std::vector<std::string> write_study(const Study& study, const std::filesystem::path& folder);

}  // namespace sunder::app::reproduce
