// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string>

#include "app/commands/commands.hpp"
#include "app/output/text.hpp"
#include "sunder/tissue_presets.hpp"

namespace sunder::app {
namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

void print(const std::string& key, const SourcedValue& value, const std::string& unit) {
  std::cout << "  " << padded(key, 11) << padded(number(value.value) + " " + unit, 18)
            << value.source << "\n";
}

void print(const std::string& key, const std::optional<SourcedValue>& value,
           const std::string& unit) {
  if (value) print(key, *value, unit);
}

}  // namespace

int list_materials() {
  for (const TissuePreset& preset : tissue_presets()) {
    std::cout << preset.name << ": " << preset.tissue << "\n";
    print("young", preset.young, "MPa");
    print("poisson", preset.poisson, "");
    print("yield", preset.yield, "MPa");
    print("toughness", preset.toughness, "MPa sqrt(mm)");
    print("energy", preset.energy, "N/mm");
    print("density", preset.density, "t/mm^3");
  }
  std::cout << "\n[material.NAME] preset = \"" << tissue_presets().front().name
            << "\" takes one; keys beside it override.\n";
  return 0;
}

}  // namespace sunder::app
