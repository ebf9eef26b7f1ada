// SPDX-License-Identifier: Apache-2.0
// Law, crack way and material constants of a body as a panel shows them, and what has been changed
// of them as keys of its scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::app {

struct SceneEdit {
  struct OfVolume {
    std::string volume;
    Material material;
  };
  std::vector<OfVolume> volumes;  ///< by name
  FractureModel model = FractureModel::none;
  CrackWay crack = CrackWay::destroyed;
  SifSource sif = SifSource::formula;
};

/// As they are.
[[nodiscard]] SceneEdit edit_of(const Problem& problem);

/// Keys that differ, as input::Set has them. A constant that is no longer there keeps its value: a
/// key cannot be taken out of a scene.
[[nodiscard]] std::vector<std::string> changes_of(const SceneEdit& before, const SceneEdit& now);

/// Whether they change the stiffness of the intact body, so that its base is prepared anew.
[[nodiscard]] bool changes_stiffness(const SceneEdit& before, const SceneEdit& now);

}  // namespace sunder::app
