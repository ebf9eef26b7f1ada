// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/description.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app::sweep {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kDescriptionFile = "sweep.json";
constexpr int kVersion = 1;

}  // namespace

std::string Part::folder() const {
  return "part-" + std::to_string(i) + "-of-" + std::to_string(n);
}

std::string Description::json() const {
  OrderedJson out;
  out["version"] = kVersion;
  out["scene"] = scene;
  out["runs"] = run_count(axes);
  OrderedJson keys = OrderedJson::array();
  for (const Axis& axis : axes) keys.push_back({{"key", axis.key}, {"values", axis.values}});
  out["vary"] = keys;
  out["set"] = overrides;
  out["part"] = {part.i, part.n};
  out["instruments"] = instruments;
  out["meshes"] = meshes;
  out["text"] = text;
  return out.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

std::optional<Description> read_description(const std::filesystem::path& folder) {
  std::ifstream in(folder / kDescriptionFile);
  if (!in) return {};
  const std::string name = (folder / kDescriptionFile).string();
  try {
    const OrderedJson json = OrderedJson::parse(in);
    if (json.at("version").get<int>() != kVersion) {
      throw UsageError(name + " is of another version of sunder");
    }
    Description d;
    d.scene = json.at("scene").get<std::string>();
    d.text = json.at("text").get<std::string>();
    d.meshes = json.at("meshes").get<std::vector<std::string>>();
    d.overrides = json.at("set").get<std::vector<std::string>>();
    for (const OrderedJson& axis : json.at("vary")) {
      d.axes.push_back(
          {axis.at("key").get<std::string>(), axis.at("values").get<std::vector<std::string>>()});
    }
    d.instruments = json.at("instruments").get<int>();
    d.part = {json.at("part").at(0).get<int>(), json.at("part").at(1).get<int>()};
    return d;
  } catch (const OrderedJson::exception&) {
    throw UsageError(name + " is not what a sweep writes; remove the folder or name another one");
  }
}

std::string difference(const Description& one, const Description& other) {
  if (one.axes.size() != other.axes.size()) {
    return "it varies " + std::to_string(other.axes.size()) + " keys and not " +
           std::to_string(one.axes.size());
  }
  for (std::size_t a = 0; a < one.axes.size(); ++a) {
    const Axis &mine = one.axes[a], &its = other.axes[a];
    if (mine.key != its.key) {
      return "it varies " + in_quotes(its.key) + " and not " + in_quotes(mine.key);
    }
    if (mine.values != its.values) return "it has other values of " + in_quotes(its.key);
  }
  if (one.overrides != other.overrides) return "it has other --set or options";
  if (one.text != other.text) return "the scene has been changed since";
  if (one.meshes != other.meshes) return "the mesh has been changed since";
  return {};
}

}  // namespace sunder::app::sweep
