// SPDX-License-Identifier: Apache-2.0
#include "app/view/scene_edit.hpp"

#include <algorithm>

#include "app/output/text.hpp"
#include "sunder/scene_keys.hpp"

namespace sunder::app {
namespace {

/// As a segment of a key's path.
std::string in_path(const std::string& volume) {
  const char quote = volume.find('"') == std::string::npos ? '"' : '\'';
  return quote + volume + quote;
}

template <class Word>
void add_word(std::vector<std::string>& changes, const std::string& table, const std::string& key,
              Word before, Word now, const std::string& path) {
  if (before == now) return;
  changes.push_back(path + "." + key + "=" +
                    key_words(table, key).at(static_cast<std::size_t>(now)));
}

void add_number(std::vector<std::string>& changes, const std::string& key,
                const std::optional<double>& before, const std::optional<double>& now) {
  if (now && now != before) changes.push_back(key + "=" + number(*now));
}

}  // namespace

SceneEdit edit_of(const Problem& problem) {
  SceneEdit edit;
  const Scene& scene = problem.scene();
  for (const auto& [volume, material] : scene.materials) edit.volumes.push_back({volume, material});
  edit.model = scene.fracture.model;
  edit.crack = scene.fracture.crack;
  edit.sif = scene.fracture.sif;
  return edit;
}

std::vector<std::string> changes_of(const SceneEdit& before, const SceneEdit& now) {
  std::vector<std::string> changes;
  for (const SceneEdit::OfVolume& of : now.volumes) {
    const auto same = std::find_if(before.volumes.begin(), before.volumes.end(),
                                   [&](const auto& other) { return other.volume == of.volume; });
    if (same == before.volumes.end()) continue;
    const Material &was = same->material, &is = of.material;
    const std::string path = "material." + in_path(of.volume);
    add_word(changes, "material", "law", was.law, is.law, path);
    add_number(changes, path + ".young", was.young, is.young);
    add_number(changes, path + ".poisson", was.poisson, is.poisson);
    add_number(changes, path + ".yield", was.yield, is.yield);
    add_number(changes, path + ".toughness", was.toughness, is.toughness);
    add_number(changes, path + ".energy", was.energy, is.energy);
    add_word(changes, "material", "volume", was.volume, is.volume, path);
  }
  add_word(changes, "fracture", "model", before.model, now.model, "fracture");
  add_word(changes, "fracture", "crack", before.crack, now.crack, "fracture");
  add_word(changes, "fracture", "sif", before.sif, now.sif, "fracture");
  return changes;
}

bool changes_stiffness(const SceneEdit& before, const SceneEdit& now) {
  return !std::equal(before.volumes.begin(), before.volumes.end(), now.volumes.begin(),
                     now.volumes.end(), [](const auto& a, const auto& b) {
                       return a.material.young == b.material.young &&
                              a.material.poisson == b.material.poisson &&
                              a.material.law == b.material.law &&
                              a.material.volume == b.material.volume;
                     });
}

}  // namespace sunder::app
