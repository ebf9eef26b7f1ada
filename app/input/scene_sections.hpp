// SPDX-License-Identifier: Apache-2.0
// The sections of a scene, one function each; scene_toml.cpp puts them together.
#pragma once

#include "app/input/scene_places.hpp"
#include "app/input/toml_table.hpp"
#include "sunder/scene.hpp"

namespace sunder::app {

[[nodiscard]] std::map<std::string, Material> read_materials(const TomlTable& root,
                                                             const std::string& file);
[[nodiscard]] std::vector<Support> read_supports(const TomlTable& root, const std::string& file);
[[nodiscard]] std::vector<Instrument> read_instruments(const TomlTable& root,
                                                       const std::string& file);
[[nodiscard]] std::vector<PresetCrack> read_cracks(const TomlTable& root, const std::string& file);
[[nodiscard]] std::vector<Interface> read_interfaces(const TomlTable& root,
                                                     const std::string& file);
[[nodiscard]] std::vector<ScriptedRemoval> read_removals(const TomlTable& root,
                                                         const std::string& file);
[[nodiscard]] FractureOptions read_fracture(const TomlTable& root, const std::string& file);
[[nodiscard]] SolverOptions read_solver(const TomlTable& root, const std::string& file);
[[nodiscard]] OutputOptions read_output(const TomlTable& root, const std::string& file);
[[nodiscard]] int read_steps(const TomlTable& root, const std::string& file);
[[nodiscard]] Vec3 read_gravity(const TomlTable& root, const std::string& file);
[[nodiscard]] std::optional<Dynamics> read_dynamics(const TomlTable& root, const std::string& file);

[[nodiscard]] ScenePlaces collect_places(const toml::table& scene, const std::string& file);

}  // namespace sunder::app
