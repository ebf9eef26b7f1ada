// SPDX-License-Identifier: Apache-2.0
// A small scene with nothing wrong in it, and what spoils it.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sunder/scene.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// 2 x 2 x 1 cells, 24 elements, nodes 0 to 17; held at y = 2.
inline Scene good_scene() {
  Scene scene;
  scene.source = "scene.toml";
  scene.mesh = structured_board(
      {2, 2, 1, 2, 2, 1}, [](const Vec3& x) { return std::string(x.y() < 1 ? "lower" : "upper"); });
  scene.materials["lower"] = {5, 0.4, 2.0};
  scene.materials["upper"] = {8, 0.4, std::nullopt};
  scene.supports.push_back({Box{Vec3(-1, 1.9, -1), Vec3(3, 3, 2)}, Axes{7}});
  return scene;
}

inline Instrument pull(NodeSelection nodes, const Vec3& force) {
  Instrument tool;
  tool.name = "forceps";
  tool.action = Pull{std::move(nodes), force};
  return tool;
}

inline Instrument grip(NodeSelection nodes, const Vec3& displacement, Axes axes = {}) {
  Instrument tool;
  tool.name = "clamp";
  tool.action = Grip{std::move(nodes), displacement, axes};
  return tool;
}

inline Instrument press(int crack) {
  Instrument tool;
  tool.name = "probe";
  tool.action = Press{Vec3(1, 1, 0), CrackSide::upper, crack, Vec3(0, 1, 0)};
  return tool;
}

inline PresetCrack crack(std::vector<Index> elements, std::optional<Vec3> mouth,
                         std::vector<Vec3> tips) {
  return {ElementSelection(std::move(elements)), mouth, std::move(tips)};
}

inline void add_second_body(Scene& scene) {
  const Index first = scene.mesh.node_count();
  for (const Vec3& x : {Vec3(9, 0, 0), Vec3(10, 0, 0), Vec3(9, 1, 0), Vec3(9, 0, 1)}) {
    scene.mesh.nodes.push_back(x);
  }
  scene.mesh.tets.push_back({first, first + 1, first + 2, first + 3});
  scene.mesh.volume_of.push_back(0);
}

inline void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << '"' << part << "\" is not in: " << text;
}

}  // namespace sunder::test
