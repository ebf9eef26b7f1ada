// SPDX-License-Identifier: Apache-2.0
// What a sweep varies: keys of a scene with the values that each takes (--vary).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sunder::app::sweep {

struct Axis {
  std::string key;                  ///< as --set takes it
  std::vector<std::string> values;  ///< TOML, or words as --set takes them
};

/// Numbers a run: 0 has the first value of every axis; the last axis is the fastest.
using RunIndex = std::int64_t;

/// Most runs of a sweep: a table that people and programs still open.
constexpr RunIndex kMostRuns = 10'000'000;

/// "key.path=a,b,c" or "key.path=lo:hi:n" (n numbers, evenly from lo to hi). Values are split at
/// commas outside brackets and quotes. Throws UsageError.
[[nodiscard]] Axis parse_axis(const std::string& text);

/// Throws UsageError too where a key comes twice, where there is none, or too many runs.
[[nodiscard]] std::vector<Axis> parse_axes(const std::vector<std::string>& texts);

[[nodiscard]] RunIndex run_count(const std::vector<Axis>& axes);

/// Which value of each axis a run has.
[[nodiscard]] std::vector<std::size_t> places_of(const std::vector<Axis>& axes, RunIndex run);

/// The run's values, one an axis.
[[nodiscard]] std::vector<std::string> values_of(const std::vector<Axis>& axes, RunIndex run);

/// The same as overrides, "key.path=value".
[[nodiscard]] std::vector<std::string> overrides_at(const std::vector<Axis>& axes,
                                                    const std::vector<std::size_t>& places);

}  // namespace sunder::app::sweep
