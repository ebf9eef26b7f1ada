// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_sections.hpp"

#include <limits>

#include "app/input/nearest.hpp"
#include "app/input/scene_selection.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

constexpr int kMostSteps = std::numeric_limits<int>::max();

// A section that may be left out: an empty table stands for it.
TomlTable section(const TomlTable& root, const std::string& file, const std::string& name,
                  std::vector<std::string> allowed) {
  static const toml::table empty;
  const toml::table* table = root.table(name);
  return TomlTable(table ? *table : empty, file, name, std::move(allowed));
}

// Calls read(table) for every table of [[name]].
template <class Read>
void for_each_table(const TomlTable& root, const std::string& file, const std::string& name,
                    const std::vector<std::string>& allowed, Read&& read) {
  int i = 0;
  for (const toml::table* table : root.tables(name))
    read(TomlTable(*table, file, name + "." + std::to_string(i++), allowed));
}

Material read_material(const TomlTable& table) {
  Material material;
  material.young = table.require("young", table.number("young"));
  material.poisson = table.require("poisson", table.number("poisson"));
  material.yield = table.number("yield");
  return material;
}

void forbid(const TomlTable& table, const std::vector<std::string>& keys, const std::string& why) {
  for (const std::string& key : keys) {
    if (table.has(key)) table.fail(InputFault::unknown_key, key, why);
  }
}

Press read_press(const TomlTable& table) {
  forbid(table, {"displacement", "axes"},
         "does not go with kind = \"pressure\": pressure takes a force");
  forbid(table, node_selection_keys(),
         "does not go with kind = \"pressure\": its nodes follow from \"at\", \"side\" and "
         "\"crack\"");
  Press press;
  press.at = table.require("at", table.vec3("at"));
  press.side = table.require(
      "side",
      table.choice<CrackSide>("side", {{"upper", CrackSide::upper}, {"lower", CrackSide::lower}}));
  press.crack = table.integer("crack", 0, std::numeric_limits<int>::max()).value_or(0);
  press.force = table.require("force", table.vec3("force"));
  return press;
}

std::variant<Pull, Grip, Press> read_expansion(const TomlTable& table) {
  forbid(table, {"at", "side", "crack"}, "goes with kind = \"pressure\" only");
  const std::string key = require_one(table, {"force", "displacement"});
  if (key == "displacement") {
    const Vec3 displacement = *table.vec3("displacement");
    return Grip{read_nodes(table), displacement, read_axes(table)};
  }
  forbid(table, {"axes"}, "goes with \"displacement\" only, not with \"force\"");
  const Vec3 force = *table.vec3("force");
  return Pull{read_nodes(table), force};
}

Instrument read_instrument(const TomlTable& table, std::size_t index) {
  Instrument instrument;
  instrument.name = table.text("name").value_or("instrument-" + std::to_string(index));
  enum class Kind { expansion, pressure };
  const Kind kind = table.require(
      "kind",
      table.choice<Kind>("kind", {{"expansion", Kind::expansion}, {"pressure", Kind::pressure}}));
  if (kind == Kind::pressure)
    instrument.action = read_press(table);
  else
    instrument.action = read_expansion(table);
  if (const auto ramp = table.numbers("ramp", 2)) instrument.ramp = Ramp{(*ramp)[0], (*ramp)[1]};
  return instrument;
}

}  // namespace

std::map<std::string, Material> read_materials(const TomlTable& root, const std::string& file) {
  std::map<std::string, Material> materials;
  const toml::table* table = root.table("material");
  if (!table) return materials;
  for (const auto& [key, node] : *table) {
    const std::string name(key.str());
    const std::string path = key_path("material", name);
    if (!node.is_table()) {
      throw InputError(InputFault::wrong_type, location(node.source(), file) + ": " + path +
                                                   " takes a table [material.<volume>], not " +
                                                   describe(node));
    }
    materials[name] =
        read_material(TomlTable(*node.as_table(), file, path, {"young", "poisson", "yield"}));
  }
  return materials;
}

std::vector<Support> read_supports(const TomlTable& root, const std::string& file) {
  std::vector<Support> supports;
  std::vector<std::string> keys = node_selection_keys();
  keys.push_back("axes");
  for_each_table(root, file, "fixed", keys, [&](const TomlTable& table) {
    supports.push_back({read_nodes(table), read_axes(table)});
  });
  return supports;
}

std::vector<Instrument> read_instruments(const TomlTable& root, const std::string& file) {
  std::vector<Instrument> instruments;
  std::vector<std::string> keys = {"name", "kind", "force", "displacement", "axes",
                                   "ramp", "at",   "side",  "crack"};
  keys.insert(keys.end(), node_selection_keys().begin(), node_selection_keys().end());
  for_each_table(root, file, "instrument", keys, [&](const TomlTable& table) {
    instruments.push_back(read_instrument(table, instruments.size()));
  });
  return instruments;
}

std::vector<PresetCrack> read_cracks(const TomlTable& root, const std::string& file) {
  std::vector<PresetCrack> cracks;
  const std::vector<std::string> keys = {"volume", "elements", "mouth", "tip", "tips"};
  for_each_table(root, file, "crack", keys, [&](const TomlTable& table) {
    PresetCrack crack;
    crack.elements = read_elements(table, {"volume", "elements"});
    if (require_one(table, {"tip", "tips"}) == "tips") {
      forbid(table, {"mouth"}, "does not go with \"tips\": an internal crack has no mouth");
      crack.tips = *table.points("tips", 2);
    } else {
      crack.tips = {*table.vec3("tip")};
      crack.mouth = table.require("mouth", table.vec3("mouth"));
    }
    cracks.push_back(std::move(crack));
  });
  return cracks;
}

std::vector<ScriptedRemoval> read_removals(const TomlTable& root, const std::string& file) {
  std::vector<ScriptedRemoval> removals;
  const std::vector<std::string> keys = {"step", "volume", "elements", "box"};
  for_each_table(root, file, "destroy", keys, [&](const TomlTable& table) {
    ScriptedRemoval removal;
    removal.step = table.require("step", table.integer("step", 0, kMostSteps));
    removal.elements = read_elements(table, {"volume", "elements", "box"});
    removals.push_back(std::move(removal));
  });
  return removals;
}

FractureOptions read_fracture(const TomlTable& root, const std::string& file) {
  const TomlTable table = section(root, file, "fracture",
                                  {"model", "alpha", "yield_measure", "sigma0", "crack_length",
                                   "sif", "max_events", "plane_normal", "birth"});
  FractureOptions options;
  options.model = table
                      .choice<FractureModel>("model", {{"none", FractureModel::none},
                                                       {"A", FractureModel::a},
                                                       {"B", FractureModel::b}})
                      .value_or(options.model);
  options.alpha = table.number("alpha").value_or(options.alpha);
  options.yield_measure =
      table
          .choice<YieldMeasure>("yield_measure", {{"max_shear", YieldMeasure::max_shear},
                                                  {"tresca", YieldMeasure::tresca}})
          .value_or(options.yield_measure);
  options.sigma0 = table
                       .choice<RemoteStress>("sigma0", {{"line", RemoteStress::line},
                                                        {"tip", RemoteStress::tip},
                                                        {"present", RemoteStress::present}})
                       .value_or(options.sigma0);
  options.crack_length = table
                             .choice<CrackLength>("crack_length", {{"path", CrackLength::path},
                                                                   {"tool", CrackLength::tool}})
                             .value_or(options.crack_length);
  options.sif =
      table.choice<SifSource>("sif", {{"formula", SifSource::formula}, {"field", SifSource::field}})
          .value_or(options.sif);
  options.birth = table
                      .choice<CrackBirth>("birth", {{"element", CrackBirth::element},
                                                    {"through", CrackBirth::through}})
                      .value_or(options.birth);
  options.max_events = table.integer("max_events", 1, kMostSteps).value_or(options.max_events);
  options.plane_normal = table.vec3("plane_normal");
  return options;
}

SolverOptions read_solver(const TomlTable& root, const std::string& file) {
  const TomlTable table =
      section(root, file, "solver",
              {"backend", "route", "update", "precision", "tolerance", "device", "prepare"});
  SolverOptions options;
  options.backend = table.text("backend").value_or(options.backend);
  options.device = table.integer("device", 0, std::numeric_limits<int>::max()).value_or(kNone);
  options.route = table
                      .choice<Route>("route", {{"auto", Route::automatic},
                                               {"inverse", Route::inverse},
                                               {"condensed", Route::condensed},
                                               {"factor", Route::factor},
                                               {"cg", Route::cg}})
                      .value_or(options.route);
  options.update = table
                       .choice<Update>("update", {{"auto", Update::automatic},
                                                  {"eager", Update::eager},
                                                  {"deferred", Update::deferred}})
                       .value_or(options.update);
  options.precision = table
                          .choice<Precision>("precision", {{"auto", Precision::automatic},
                                                           {"fp32", Precision::fp32},
                                                           {"fp64", Precision::fp64}})
                          .value_or(options.precision);
  options.tolerance = table.number("tolerance").value_or(options.tolerance);
  options.prepare = table.boolean("prepare").value_or(options.prepare);
  return options;
}

OutputOptions read_output(const TomlTable& root, const std::string& file) {
  const TomlTable table = section(root, file, "output", {"fields"});
  OutputOptions options;
  const auto fields = table.texts("fields");
  if (!fields) return options;
  options.displacement = options.stress = false;
  for (const std::string& field : *fields) {
    if (field == "displacement")
      options.displacement = true;
    else if (field == "stress")
      options.stress = true;
    else
      table.fail(InputFault::unknown_key, "fields",
                 "contains " + in_quotes(field, 40) +
                     "; allowed: " + quoted_list({"displacement", "stress"}, "and"));
  }
  return options;
}

int read_steps(const TomlTable& root, const std::string& file) {
  const TomlTable table = section(root, file, "time", {"steps"});
  return table.integer("steps", 1, kMostSteps).value_or(1);
}

}  // namespace sunder::app
