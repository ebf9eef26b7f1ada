// SPDX-License-Identifier: Apache-2.0
#include "app/commands/view_bodies.hpp"

#include <algorithm>
#include <utility>

#include "app/commands/mesh_scene.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_toml.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kBodies = 2;  // whose preparation is kept: one can change back

/// Whether "auto" computes on the processors here.
bool auto_is_cpu() {
  for (const DeviceInfo& device : devices()) {
    if (device.chosen) return device.backend == "cpu";
  }
  return true;
}

}  // namespace

ViewBodies::ViewBodies(SceneArguments arguments, std::vector<std::string>& warnings, bool change)
    : arguments_(std::move(arguments)), warnings_(warnings) {
  if (change && auto_is_cpu()) prepared_ = prepared_bodies(kBodies);
}

SceneArguments ViewBodies::arguments_of(const Origin& origin) const {
  SceneArguments arguments = arguments_;
  if (origin.file != arguments_.scene) arguments.set.clear();
  arguments.scene = origin.file;
  if (is_mesh_file(origin.file)) arguments.text = scene_of_mesh(origin.file);
  arguments.set.insert(arguments.set.end(), origin.changes.begin(), origin.changes.end());
  return arguments;
}

OpenedScene ViewBodies::open(const Origin& origin, bool live) const {
  OpenedScene opened = open_scene(arguments_of(origin), live);
  if (!opened.recording.empty()) {
    throw InputError(
        InputFault::unknown_key,
        origin.file.string() + ": recording is for sunder run and plan; leave the key out here");
  }
  return opened;
}

BodyPlan ViewBodies::body(std::shared_ptr<const Problem> problem, view::Devices& devices) const {
  BodyPlan plan;
  plan.problem = problem;
  if (problem->scene().solver.backend == "vulkan") {
    plan.points = std::make_shared<view::SharedPoints>();
  }
  plan.make = [this, problem = std::move(problem), points = plan.points, &devices] {
    const Needs needs = needs_of(*problem);
    CreatedBackend created;
    if (points) {
      points->leave();
      view::Device& device = devices.now();
      created = create_backend_on(problem, needs, device.lend());
      points->begin(device);
    } else {
      created = prepared_ ? create_prepared_backend(problem, needs, prepared_)
                          : create_backend(problem, needs);
    }
    for (std::string& w : created.warnings) {
      if (std::ranges::find(warnings_, w) == warnings_.end()) warnings_.push_back(std::move(w));
    }
    return std::move(created.backend);
  };
  return plan;
}

PlanBody ViewBodies::plan(view::Devices& devices) const {
  return [this, &devices](const Origin& origin) {
    constexpr bool kLive = true;
    OpenedScene opened = open(origin, kLive);
    if (opened.inputs && origin.file != arguments_.scene) {
      throw InputError(InputFault::unknown_key,
                       origin.file.string() +
                           ": the scene has inputs, which are not played here; leave the key out");
    }
    BodyPlan plan = body(opened.problem, devices);
    plan.warnings = std::move(opened.warnings);
    return plan;
  };
}

std::string ViewBodies::text_for(const Origin& origin, const std::filesystem::path& folder,
                                 const std::string& inputs) const {
  const SceneArguments arguments = arguments_of(origin);
  return scene_text_for(arguments.scene, overrides_of(arguments), folder, inputs,
                        arguments.text ? &*arguments.text : nullptr);
}

}  // namespace sunder::app
