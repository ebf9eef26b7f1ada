// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_places.hpp"

#include <optional>

#include "app/input/scene_sections.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

class Collector {
 public:
  Collector(const toml::table& scene, const std::string& file) : scene_(scene) {
    found_.file = file;
  }

  ScenePlaces collect() {
    if (const toml::table* materials = scene_["material"].as_table()) {
      for (const auto& [name, node] : *materials)
        add("material " + in_quotes(name.str()), node.source());
    }
    for (const char* key : {"fixed", "crack", "interface", "destroy"}) add_array(key);
    add_instruments();
    for (const char* section : {"fracture", "solver", "time", "load", "dynamics"})
      add_options(section);
    return std::move(found_);
  }

 private:
  void add(std::string thing, const toml::source_region& region) {
    found_.places.emplace_back(std::move(thing) + ' ', location(region, found_.file));
  }

  void add_array(const std::string& key) {
    const toml::array* tables = scene_[key].as_array();
    for (std::size_t i = 0; tables && i < tables->size(); ++i)
      add(key + ' ' + std::to_string(i), (*tables)[i].source());
  }

  void add_instruments() {
    const toml::array* tables = scene_["instrument"].as_array();
    for (std::size_t i = 0; tables && i < tables->size(); ++i) {
      const toml::node& table = (*tables)[i];
      const auto name = table.is_table() ? (*table.as_table())["name"].value<std::string>()
                                         : std::optional<std::string>();
      add("instrument " + in_quotes(name.value_or("instrument-" + std::to_string(i))),
          table.source());
    }
  }

  void add_options(const std::string& section) {
    const toml::table* table = scene_[section].as_table();
    if (!table) return;
    for (const auto& [key, node] : *table)
      add(section + '.' + std::string(key.str()), node.source());
  }

  const toml::table& scene_;
  ScenePlaces found_;
};

}  // namespace

ScenePlaces collect_places(const toml::table& scene, const std::string& file) {
  return Collector(scene, file).collect();
}

InputError ScenePlaces::located(const InputError& error) const {
  const std::string message = error.what();
  const std::string head = file + ": ";
  if (!message.starts_with(head)) return error;
  const std::string rest = message.substr(head.size());
  for (const auto& [thing, place] : places) {
    if (rest.starts_with(thing)) return InputError(error.fault(), place + ": " + rest);
  }
  return error;
}

}  // namespace sunder::app
