// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_key_pages.hpp"

#include <set>
#include <stdexcept>

#include "sunder/scene_keys.hpp"
#include "sunder/tissue_presets.hpp"
#include "sunder/words.hpp"

namespace sunder::test {
namespace {

std::string heading(const SceneKey& key) {
  const std::string name(key.name);
  if (name == "material") return "[material.NAME]";
  if (name == "fibres") return "[[material.NAME.fibres]]";
  if (name == "around") return "[material.NAME.fibres.around]";
  return key.type == KeyType::tables ? "[[" + name + "]]" : "[" + name + "]";
}

std::string kind(const SceneKey& key) {
  std::string words;
  switch (key.type) {
    case KeyType::text:
      return "string";
    case KeyType::number:
      return "number";
    case KeyType::integer:
      return "integer";
    case KeyType::boolean:
      return "true, false";
    case KeyType::word:
      for (const std::string& word : key.words)
        words += (words.empty() ? "\"" : ", \"") + word + '"';
      return words;
    case KeyType::vector:
      return "[x, y, z]";
    case KeyType::points:
      return "two [x, y, z]";
    case KeyType::curve:
      return "two or more [x, y, z]";
    case KeyType::range:
      return "two numbers";
    case KeyType::ids:
      return "ids";
    case KeyType::texts:
      return "strings";
    default:
      return "";
  }
}

std::string cell(std::string_view text) {
  return text.empty() ? " |" : ' ' + std::string(text) + " |";
}

std::string row(const SceneKey& key) {
  const std::string name =
      key.type == KeyType::nodes ? "a selection of nodes" : '`' + std::string(key.name) + '`';
  const std::string standard = key.required           ? "(needed)"
                               : key.standard.empty() ? ""
                                                      : '`' + key.standard + '`';
  return '|' + cell(name) + cell(kind(key)) + cell(standard) + cell(key.meaning) + cell(key.wrong) +
         '\n';
}

bool is_table(const SceneKey& key) {
  return key.type == KeyType::table || key.type == KeyType::tables;
}

/// Tables of a table come after its rows, each with its own.
std::string rows_of(std::string_view table) {
  std::string rows, tables;
  for (const SceneKey& key : scene_keys()) {
    if (key.table != table) continue;
    if (!is_table(key) || table.empty()) {
      rows += row(key);
      continue;
    }
    tables += "| **`" + heading(key) + "`** | | | **" + std::string(key.meaning) + "** |" +
              cell(key.wrong) + '\n' + rows_of(key.name);
  }
  return rows + tables;
}

std::string key_table() {
  std::string text = "| key | type | default | meaning | wrong, or odd |\n|---|---|---|---|---|\n";
  for (const SceneKey& key : scene_keys()) {
    if (!key.table.empty()) continue;
    if (!is_table(key)) {
      text += row(key);
      continue;
    }
    text += "| **`" + heading(key) + "`** | | | **" + std::string(key.meaning) + "** |" +
            cell(key.wrong) + '\n' + rows_of(key.name);
  }
  return text +
         "| **a selection of nodes** | | | **exactly one of `box`, `nodes`, `near` with `radius`, "
         "`surface`** | none or two of them: error |\n" +
         rows_of("nodes");
}

constexpr std::string_view kBegin =
    "<!-- keys: written by scene_keys from core/scene/scene_keys.cpp -->\n";
constexpr std::string_view kEnd = "<!-- end of keys -->\n";

}  // namespace

std::string with_key_table(const std::string& page) {
  const std::size_t begin = page.find(kBegin), end = page.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    throw std::runtime_error("the page has no place for the keys: lines \"" +
                             std::string(kBegin, 0, kBegin.size() - 1) + "\" and \"" +
                             std::string(kEnd, 0, kEnd.size() - 1) + "\"");
  }
  return page.substr(0, begin + kBegin.size()) + '\n' + key_table() + '\n' + page.substr(end);
}

std::string scene_dictionary() {
  std::set<std::string> entries;  // \" as the format of libFuzzer has it
  for (const SceneKey& key : scene_keys()) {
    const std::string name(key.name);
    if (key.type == KeyType::nodes) continue;
    if (name == "material" && key.table.empty()) {
      entries.insert("[material.");
    } else if (is_table(key)) {
      entries.insert(key.table.empty() ? heading(key) : name + " = {");
    } else {
      entries.insert(name + " = ");
    }
    for (const std::string& word : key.words) entries.insert("\\\"" + word + "\\\"");
  }
  std::string text =
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Written by scene_keys from core/scene/scene_keys.cpp.\n";
  for (const std::string& entry : entries) text += '"' + entry + "\"\n";
  // What breaks readers of numbers and of TOML.
  return text +
         "\"nan\"\n\"inf\"\n\"1e400\"\n\"\\x0a%%\\x0a\"\n\"\\\"\\\"\\\"\"\n\"'''\"\n"
         "\"0x7fffffffffffffff\"\n";
}

std::string tissues_page() {
  std::string text =
      "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
      "# Tissues\n\n"
      "What `preset` of a material means (`core/scene/tissue_presets.cpp`, from which `scene_keys "
      ".` "
      "writes this page). `sunder materials` prints the same, the C interface has them as "
      "`sunder_material_preset`. Keys beside `preset` override.\n\n"
      "Numbers of soft tissue differ by species, age, rate and the way of measuring by a factor of "
      "two and more; \"order of magnitude\" says where not even that is sure. What nobody is known "
      "to have measured is left out. `yield` is compared with the maximum shear stress, half of a "
      "pull: it is half of a tensile strength. 1 N/mm = 1000 J/m^2.\n\n"
      "| preset | key | value | source |\n|---|---|---:|---|\n";
  const auto add = [&text](const std::string& name, const std::string& key, const SourcedValue& v,
                           const std::string& unit) {
    text += "| " + name + " | `" + key + "` | " + in_digits(v.value) + unit + " | " +
            std::string(v.source) + " |\n";
  };
  for (const TissuePreset& p : tissue_presets()) {
    text += "| **" + std::string(p.name) + "** | | | " + std::string(p.tissue) + " |\n";
    add("", "young", p.young, " MPa");
    add("", "poisson", p.poisson, "");
    if (p.yield) add("", "yield", *p.yield, " MPa");
    if (p.toughness) add("", "toughness", *p.toughness, " MPa sqrt(mm)");
    if (p.energy) add("", "energy", *p.energy, " N/mm");
    if (p.density) add("", "density", *p.density, " t/mm^3");
  }
  return text;
}

}  // namespace sunder::test
