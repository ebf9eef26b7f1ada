// SPDX-License-Identifier: Apache-2.0
// sweep.csv and sweep.html.
#pragma once

#include <string>

#include "app/sweep/description.hpp"
#include "app/sweep/rows.hpp"

namespace sunder::app::sweep {

/// Header and a line for each run that is there, by number, the varied keys first.
[[nodiscard]] std::string sweep_csv(const Description& sweep, const Rows& rows);

/// A page that opens without a network: any column over any key. `note`: what is missing; or empty.
[[nodiscard]] std::string sweep_html(const Description& sweep, const Rows& rows,
                                     const std::string& note);

}  // namespace sunder::app::sweep
