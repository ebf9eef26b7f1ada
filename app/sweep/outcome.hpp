// SPDX-License-Identifier: Apache-2.0
// One run of a sweep as a row of its table.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/sweep/axes.hpp"
#include "sunder/backends.hpp"

namespace sunder::app::sweep {

/// Names of the columns behind the varied keys; so many instruments have columns of their own.
[[nodiscard]] std::vector<std::string> columns(int instruments);

/// That `sunder run` would have had, by the row of a run.
[[nodiscard]] int exit_code_of(const std::string& row);

/// What a run has come to: its row behind the varied keys, without an end of line.
struct Outcome {
  RunIndex run = 0;
  std::string row;
};

/// Makes the problem, computes its steps and returns the row. A scene that is wrong, a device that
/// cannot, or a computation that cannot keep its promise, is a row that says so. Nothing: `stop`
/// said true before it was done.
[[nodiscard]] std::optional<Outcome> compute(
    RunIndex run, const std::function<std::shared_ptr<const Problem>()>& make_problem,
    const std::shared_ptr<cpu_reference::PreparedBodies>& prepared, int instruments,
    const std::function<bool()>& stop);

}  // namespace sunder::app::sweep
