// SPDX-License-Identifier: Apache-2.0
// What holds, drives and cuts the body.
#include "c/scene.hpp"
#include "c/structs.hpp"

namespace {

using namespace sunder::c;
using sunder::Vec3;

sunder::Axes to_axes(std::uint32_t axes) {
  if (axes < 1 || axes > SUNDER_AXES_ALL) {
    throw Failure(SUNDER_ERROR_VALUE,
                  "axes = " + std::to_string(axes) + " is no sum of SUNDER_AXIS_X, _Y and _Z");
  }
  return {static_cast<std::uint8_t>(axes)};
}

sunder::Instrument to_instrument(SceneObject& object, const sunder_instrument& given) {
  sunder::Instrument tool;
  require_finite(given.value, 3, "value");
  const Vec3 value(given.value);
  if (given.has_ramp) {
    require_finite(given.ramp, 2, "ramp");
    tool.ramp = sunder::Ramp{given.ramp[0], given.ramp[1]};
  }
  switch (choice<int>(given.kind, 3, "instrument kind")) {
    case SUNDER_FORCE:
      tool.action = sunder::Pull{to_nodes(object, given.nodes, "instrument"), value};
      break;
    case SUNDER_DISPLACEMENT: {
      require_finite(given.turn, 3, "turn");
      const sunder::Axes axes = to_axes(given.axes);
      tool.action = sunder::Grip{to_nodes(object, given.nodes, "instrument"), value, axes,
                                 given.rigid != 0, Vec3(given.turn)};
      break;
    }
    default:
      require_finite(given.at, 3, "at");
      tool.action =
          sunder::Press{Vec3(given.at), choice<sunder::CrackSide>(given.side, 2, "instrument side"),
                        given.crack, value};
  }
  return tool;
}

}  // namespace

extern "C" {

void sunder_support_init(sunder_support* support) {
  if (!support) return;
  *support = sized<sunder_support>();
  support->axes = SUNDER_AXES_ALL;
}

sunder_status sunder_scene_add_support(sunder_scene scene, const sunder_support* support) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(support, sized<sunder_support>(), "support");
    const sunder::Axes axes = to_axes(given.axes);
    object.scene.supports.push_back({to_nodes(object, given.nodes, "support"), axes});
  });
}

void sunder_instrument_init(sunder_instrument* instrument) {
  if (!instrument) return;
  *instrument = sized<sunder_instrument>();
  instrument->axes = SUNDER_AXES_ALL;
}

sunder_status sunder_scene_add_instrument(sunder_scene scene, const sunder_instrument* instrument,
                                          int32_t* index) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(instrument, sized<sunder_instrument>(), "instrument");
    auto& all = object.scene.instruments;
    sunder::Instrument tool = to_instrument(object, given);
    tool.name = given.name ? given.name : std::to_string(all.size());
    all.push_back(std::move(tool));
    if (index) *index = static_cast<int32_t>(all.size()) - 1;
  });
}

void sunder_preset_crack_init(sunder_preset_crack* crack) {
  if (crack) *crack = sized<sunder_preset_crack>();
}

sunder_status sunder_scene_add_crack(sunder_scene scene, const sunder_preset_crack* crack) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    const auto given = read_struct(crack, sized<sunder_preset_crack>(), "crack");
    sunder::PresetCrack preset{to_elements(given.elements, "crack"), {}, {Vec3(given.tips[0])}};
    require_finite(given.tips[0], 3, "tips[0]");
    require_finite(given.has_mouth ? given.mouth : given.tips[1], 3,
                   given.has_mouth ? "mouth" : "tips[1]");
    if (given.has_mouth) {
      preset.mouth = Vec3(given.mouth);
    } else {
      preset.tips.emplace_back(given.tips[1]);
    }
    object.scene.cracks.push_back(std::move(preset));
  });
}

sunder_status sunder_scene_add_removal(sunder_scene scene, int32_t step,
                                       const sunder_selection* elements) {
  return call<SceneObject>(scene, [&](SceneObject& object) {
    require(elements, "elements");
    object.scene.removals.push_back({step, to_elements(*elements, "removal")});
  });
}

}  // extern "C"
