// SPDX-License-Identifier: Apache-2.0
// The bodies that a view looks at one after the other: that of its scene or mesh, what the scene
// is changed to, and those of other files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/commands/scene_arguments.hpp"
#include "app/view/body.hpp"
#include "app/view/vulkan/device.hpp"

namespace sunder::cpu_reference {
class PreparedBodies;
}

namespace sunder::app {

class ViewBodies {
 public:
  /// Warnings of backends, each once, go to `warnings`, which outlives this. `change`: bodies will;
  /// what is prepared on the processors is kept for the next one.
  ViewBodies(SceneArguments arguments, std::vector<std::string>& warnings, bool change);

  /// That of the arguments.
  [[nodiscard]] Origin first() const { return {arguments_.scene, {}}; }
  /// Of another file the arguments hold without --set. Throws InputError.
  [[nodiscard]] OpenedScene open(const Origin& origin, bool live) const;
  /// The body of a problem. It makes its backend as often as it is asked for: on the device that
  /// draws where Vulkan is to compute. This and the devices outlive it.
  [[nodiscard]] BodyPlan body(std::shared_ptr<const Problem> problem, view::Devices& devices) const;
  /// For bodies that a hand does anything to. This and the devices outlive it.
  [[nodiscard]] PlanBody plan(view::Devices& devices) const;
  /// The text of the scene for a folder, with inputs beside it; empty: none.
  [[nodiscard]] std::string text_for(const Origin& origin, const std::filesystem::path& folder,
                                     const std::string& inputs) const;

 private:
  [[nodiscard]] SceneArguments arguments_of(const Origin& origin) const;

  SceneArguments arguments_;
  std::vector<std::string>& warnings_;
  std::shared_ptr<cpu_reference::PreparedBodies> prepared_;  // null: nothing is kept
};

}  // namespace sunder::app
