// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_sections.hpp"

#include <algorithm>
#include <limits>

#include "app/input/nearest.hpp"
#include "app/input/scene_selection.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/scene_keys.hpp"
#include "sunder/tissue_presets.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

constexpr int kMostSteps = std::numeric_limits<int>::max();

// A section that may be left out: an empty table stands for it.
TomlTable section(const TomlTable& root, const std::string& file, const std::string& name) {
  static const toml::table empty;
  const toml::table* table = root.table(name);
  return TomlTable(table ? *table : empty, file, name, key_names(name));
}

// A key that fills a member; these types alone do.
std::optional<KeyValue> read_value(const TomlTable& table, const SceneKey& key) {
  switch (key.type) {
    case KeyType::boolean:
      return table.boolean(key.name);
    case KeyType::integer:
      return table.integer(key.name, key.least, kMostSteps);
    case KeyType::word:
      return table.word(key.name, key.words);
    case KeyType::number:
      return table.number(key.name);
    case KeyType::vector:
      return table.vec3(key.name);
    default:
      return table.text(key.name);
  }
}

/// `filled`: what is needed is there already.
template <class Owner>
void read_members(const TomlTable& table, std::span<const MemberKey<Owner>> keys, Owner& owner,
                  bool filled = false) {
  for (const MemberKey<Owner>& key : keys) {
    if (const std::optional<KeyValue> value = read_value(table, key)) {
      key.set(owner, *value);
    } else if (key.required && !filled) {
      table.fail_missing(key.name);
    }
  }
}

// One of the words of a key of the scene, as the value with its place.
template <class Value>
std::optional<Value> read_word(const TomlTable& table, std::string_view section,
                               std::string_view key) {
  const auto place = table.word(key, key_words(section, key));
  return place ? std::optional(static_cast<Value>(*place)) : std::nullopt;
}

// Calls read(table) for every table of [[name]].
template <class Read>
void for_each_table(const TomlTable& root, const std::string& file, const std::string& name,
                    Read&& read) {
  const std::vector<std::string> allowed = key_names(name);
  int i = 0;
  for (const toml::table* table : root.tables(name))
    read(TomlTable(*table, file, name + "." + std::to_string(i++), allowed));
}

const TissuePreset* read_preset(const TomlTable& table) {
  const auto name = table.text("preset");
  if (!name) return nullptr;
  const TissuePreset* preset = find_preset(*name);
  if (preset) return preset;
  const std::string close = nearest(*name, preset_names());
  table.fail(InputFault::unknown_key, "preset",
             "is " + in_quotes(*name) +
                 (close.empty() ? "" : ", perhaps " + in_quotes(close) + " was meant") +
                 "; allowed: " + quoted_list(preset_names()));
}

void forbid(const TomlTable& table, const std::vector<std::string>& keys, const std::string& why) {
  for (const std::string& key : keys) {
    if (table.has(key)) table.fail(InputFault::unknown_key, key, why);
  }
}

Fibres read_fibres(const TomlTable& table, const std::string& file) {
  Fibres fibres;
  const std::string key = require_one(table, {"direction", "around", "curve", "field"});
  if (key != "direction") {
    forbid(table, {"surface"}, "goes with \"direction\" only, which is laid along it");
  }
  if (key == "direction") {
    const auto surface = table.text("surface");
    const Vec3 direction = *table.vec3("direction");
    if (surface) {
      fibres.direction = AlongSurface{*surface, direction};
    } else {
      fibres.direction = direction;
    }
  } else if (key == "curve") {
    fibres.direction = AlongCurve{*table.curve("curve")};
  } else if (key == "field") {
    fibres.direction = FieldName{*table.text("field")};
  } else {
    const TomlTable around(*table.table("around"), file, table.full("around"), key_names("around"));
    fibres.direction = AroundAxis{around.require("point", around.vec3("point")),
                                  around.require("axis", around.vec3("axis"))};
  }
  fibres.k1 = table.number("k1");
  fibres.k2 = table.number("k2");
  fibres.dispersion = table.number("dispersion").value_or(0);
  fibres.young_along = table.number("young_along");
  fibres.poisson_along = table.number("poisson_along");
  fibres.shear_along = table.number("shear_along");
  fibres.yield_across = table.number("yield_across");
  fibres.toughness_across = table.number("toughness_across");
  fibres.energy_across = table.number("energy_across");
  return fibres;
}

Material read_material(const TomlTable& table, const std::string& file) {
  Material material;
  const TissuePreset* preset = read_preset(table);
  if (preset) material = preset->material();
  if (table.has("toughness") || table.has("energy")) material.toughness = material.energy = {};
  read_members(table, material_keys(), material, preset != nullptr);
  const std::vector<std::string> of_fibres = key_names("fibres");
  const auto families = table.table_or_tables("fibres");
  for (std::size_t i = 0; i < families.size(); ++i) {
    const std::string path = table.full("fibres") + (i > 0 ? "." + std::to_string(i) : "");
    material.fibres.push_back(read_fibres(TomlTable(*families[i], file, path, of_fibres), file));
  }
  return material;
}

Press read_press(const TomlTable& table) {
  forbid(table, {"displacement", "axes", "rigid", "turn"},
         "does not go with kind = \"pressure\": pressure takes a force");
  forbid(table, key_names("nodes"),
         "does not go with kind = \"pressure\": its nodes follow from \"at\", \"side\" and "
         "\"crack\"");
  Press press;
  press.at = table.require("at", table.vec3("at"));
  press.side = table.require("side", read_word<CrackSide>(table, "instrument", "side"));
  press.crack = table.integer("crack", 0, std::numeric_limits<int>::max()).value_or(0);
  press.force = table.require("force", table.vec3("force"));
  return press;
}

std::variant<Pull, Grip, Press> read_expansion(const TomlTable& table) {
  forbid(table, {"at", "side", "crack"}, "goes with kind = \"pressure\" only");
  const bool rigid = table.boolean("rigid").value_or(false);
  const Vec3 turn = table.vec3("turn").value_or(Vec3::Zero());
  const std::string key = require_one(table, {"force", "displacement"});
  if (key == "displacement") {
    const Vec3 displacement = *table.vec3("displacement");
    Grip grip{read_nodes(table), displacement, read_axes(table)};
    if (!rigid) forbid(table, {"turn"}, "goes with \"rigid = true\" only");
    grip.rigid = rigid;
    grip.turn = turn;
    return grip;
  }
  forbid(table, {"axes", "rigid", "turn"}, "goes with \"displacement\" only, not with \"force\"");
  const Vec3 force = *table.vec3("force");
  return Pull{read_nodes(table), force};
}

Instrument read_instrument(const TomlTable& table, std::size_t index) {
  Instrument instrument;
  instrument.name = table.text("name").value_or("instrument-" + std::to_string(index));
  enum class Kind { expansion, pressure };
  const Kind kind = table.require("kind", read_word<Kind>(table, "instrument", "kind"));
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
        read_material(TomlTable(*node.as_table(), file, path, key_names("material")), file);
  }
  return materials;
}

std::vector<Support> read_supports(const TomlTable& root, const std::string& file) {
  std::vector<Support> supports;
  for_each_table(root, file, "fixed", [&](const TomlTable& table) {
    supports.push_back({read_nodes(table), read_axes(table)});
  });
  return supports;
}

std::vector<Instrument> read_instruments(const TomlTable& root, const std::string& file) {
  std::vector<Instrument> instruments;
  for_each_table(root, file, "instrument", [&](const TomlTable& table) {
    instruments.push_back(read_instrument(table, instruments.size()));
  });
  return instruments;
}

std::vector<PresetCrack> read_cracks(const TomlTable& root, const std::string& file) {
  std::vector<PresetCrack> cracks;
  for_each_table(root, file, "crack", [&](const TomlTable& table) {
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

std::vector<Interface> read_interfaces(const TomlTable& root, const std::string& file) {
  std::vector<Interface> interfaces;
  for_each_table(root, file, "interface", [&](const TomlTable& table) {
    Interface interface;
    const auto between = table.require("between", table.texts("between"));
    if (between.size() != 2) {
      table.fail(InputFault::wrong_type, "between",
                 "has " + count_of(static_cast<long long>(between.size()), "name") +
                     "; allowed: the names of two volumes");
    }
    std::ranges::copy(between, interface.between.begin());
    interface.strength = table.require("strength", table.number("strength"));
    interface.energy = table.require("energy", table.number("energy"));
    interface.shear_ratio = table.number("shear_ratio").value_or(interface.shear_ratio);
    interfaces.push_back(std::move(interface));
  });
  return interfaces;
}

std::vector<ScriptedRemoval> read_removals(const TomlTable& root, const std::string& file) {
  std::vector<ScriptedRemoval> removals;
  for_each_table(root, file, "destroy", [&](const TomlTable& table) {
    ScriptedRemoval removal;
    removal.step = table.require("step", table.integer("step", 0, kMostSteps));
    removal.elements = read_elements(table, {"volume", "elements", "box"});
    removals.push_back(std::move(removal));
  });
  return removals;
}

FractureOptions read_fracture(const TomlTable& root, const std::string& file) {
  FractureOptions options;
  read_members(section(root, file, "fracture"), fracture_keys(), options);
  return options;
}

SolverOptions read_solver(const TomlTable& root, const std::string& file) {
  SolverOptions options;
  read_members(section(root, file, "solver"), solver_keys(), options);
  return options;
}

OutputOptions read_output(const TomlTable& root, const std::string& file) {
  const TomlTable table = section(root, file, "output");
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
  Scene scene;
  read_members(section(root, file, "time"), time_keys(), scene);
  return scene.steps;
}

Vec3 read_gravity(const TomlTable& root, const std::string& file) {
  Scene scene;
  read_members(section(root, file, "load"), load_keys(), scene);
  return scene.gravity;
}

std::optional<Dynamics> read_dynamics(const TomlTable& root, const std::string& file) {
  if (!root.table("dynamics")) return std::nullopt;
  const TomlTable table = section(root, file, "dynamics");
  Dynamics dynamics;
  read_members(table, dynamics_keys(), dynamics);
  if (const auto damping = table.numbers("damping", 2)) {
    dynamics.mass_damping = (*damping)[0];
    dynamics.stiffness_damping = (*damping)[1];
  }
  return dynamics;
}

}  // namespace sunder::app
