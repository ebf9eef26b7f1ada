// SPDX-License-Identifier: Apache-2.0
// sweep.json: what a sweep is, so that --resume and --merge go on with the same one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/sweep/axes.hpp"

namespace sunder::app::sweep {

/// Which runs a folder holds: those whose number leaves i - 1 when divided by n.
struct Part {
  int i = 1, n = 1;
  [[nodiscard]] bool whole() const { return n == 1; }
  [[nodiscard]] bool has(RunIndex run) const { return run % n == i - 1; }
  [[nodiscard]] RunIndex count(RunIndex runs) const { return (runs - i + n) / n; }
  /// "part-2-of-8".
  [[nodiscard]] std::string folder() const;
};

struct Description {
  std::string scene;                   ///< path, for people
  std::string text;                    ///< of the scene
  std::vector<std::string> meshes;     ///< a fingerprint each
  std::vector<std::string> overrides;  ///< those of --set and its kin
  std::vector<Axis> axes;
  int instruments = 0;
  Part part;

  [[nodiscard]] std::string json() const;
};

/// Of sweep.json in a folder; nothing: there is none. Throws UsageError where it cannot be read.
[[nodiscard]] std::optional<Description> read_description(const std::filesystem::path& folder);

/// In which way two sweeps are different ones, their part and the scene's path left out; empty: in
/// none.
[[nodiscard]] std::string difference(const Description& one, const Description& other);

}  // namespace sunder::app::sweep
