// SPDX-License-Identifier: Apache-2.0
// The study as text: JSON, CSV, a summary in Markdown, one page of HTML.
#pragma once

#include <map>
#include <string>

#include "app/reproduce/study.hpp"

namespace sunder::app::reproduce {

[[nodiscard]] std::string study_json(const Study& study);
[[nodiscard]] std::string csv(const DataTable& table);
[[nodiscard]] std::string study_markdown(const Study& study);
/// A chart as a file of its own: with the colours that the page's style sheet gives it.
[[nodiscard]] std::string standalone(const Drawing& drawing);
/// `pngs`: by name of the drawing.
[[nodiscard]] std::string study_page(const Study& study,
                                     const std::map<std::string, std::string>& pngs);

}  // namespace sunder::app::reproduce
