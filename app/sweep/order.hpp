// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "app/sweep/description.hpp"
#include "app/sweep/rows.hpp"

namespace sunder::app::sweep {

/// The runs of a part that are not done yet, in the order in which they are computed: those of one
/// body together, whichever axis of `changes_body` makes bodies others, by number within.
[[nodiscard]] std::vector<RunIndex> runs_to_do(const std::vector<Axis>& axes, const Part& part,
                                               const Rows& done,
                                               const std::vector<bool>& changes_body);

}  // namespace sunder::app::sweep
