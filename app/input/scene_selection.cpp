// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_selection.hpp"

#include "app/input/nearest.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

Box read_box(const TomlTable& table) {
  const std::vector<Vec3> corners = table.require("box", table.points("box", 2));
  for (int axis = 0; axis < 3; ++axis) {
    if (!(corners[0][axis] <= corners[1][axis])) {
      table.fail(InputFault::out_of_range, "box",
                 std::string("has its maximum below its minimum along ") + "xyz"[axis] +
                     "; allowed: [[min], [max]] with min <= max");
    }
  }
  return {corners[0], corners[1]};
}

Ball read_ball(const TomlTable& table) {
  Ball ball;
  ball.center = table.require("near", table.vec3("near"));
  ball.radius = table.require("radius", table.number("radius"));
  if (!(ball.radius >= 0)) table.fail(InputFault::out_of_range, "radius", "must be 0 or more");
  return ball;
}

}  // namespace

std::string require_one(const TomlTable& table, const std::vector<std::string>& keys) {
  std::string found;
  for (const std::string& key : keys) {
    if (!table.has(key)) continue;
    if (!found.empty()) {
      throw InputError(InputFault::unknown_key,
                       table.where(key) + ": " + table.path() + " has both \"" + found +
                           "\" and \"" + key + "\"; allowed: exactly one of " + quoted_list(keys));
    }
    found = key;
  }
  if (found.empty()) {
    throw InputError(InputFault::missing_key, table.where() + ": " + table.path() +
                                                  " needs one of the keys " + quoted_list(keys));
  }
  return found;
}

NodeSelection read_nodes(const TomlTable& table) {
  const std::string key = require_one(table, {"box", "nodes", "near", "surface"});
  if (table.has("radius") && key != "near")
    table.fail(InputFault::unknown_key, "radius", "goes with \"near\" only");
  if (key == "box") return read_box(table);
  if (key == "near") return read_ball(table);
  if (key == "surface") return SurfaceName{*table.text("surface")};
  return *table.ids("nodes");
}

ElementSelection read_elements(const TomlTable& table, const std::vector<std::string>& keys) {
  const std::string key = require_one(table, keys);
  if (key == "box") return read_box(table);
  if (key == "volume") return VolumeName{*table.text("volume")};
  return *table.ids("elements");
}

Axes read_axes(const TomlTable& table) {
  const std::optional<std::string> word = table.text("axes");
  if (!word) return Axes{};
  Axes axes{0};
  for (const char c : *word) {
    const std::size_t axis = std::string_view("xyz").find(c);
    if (axis == std::string_view::npos || axes.has(static_cast<int>(axis))) {
      axes.bits = 0;
      break;
    }
    axes.bits = static_cast<std::uint8_t>(axes.bits | (1U << axis));
  }
  if (axes.bits == 0) {
    table.fail(InputFault::unknown_key, "axes",
               "is " + in_quotes(*word, 20) +
                   "; allowed: one or more of the letters x, y, z, each once, e.g. \"xy\"");
  }
  return axes;
}

}  // namespace sunder::app
