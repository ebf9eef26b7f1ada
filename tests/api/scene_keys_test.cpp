// SPDX-License-Identifier: Apache-2.0
// The options of the C interface against the table of scene keys: each key has its member, whose
// default is the key's, and takes as many values as the key has words.
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <string>
#include <variant>

#include "sunder/scene_keys.hpp"
#include "sunder/sunder.h"

namespace sunder::test {
namespace {

template <class Options>
using Member = std::variant<int32_t Options::*, double Options::*>;

const std::map<std::string, Member<sunder_fracture_options>>& fracture_members() {
  using O = sunder_fracture_options;
  static const std::map<std::string, Member<O>> members{
      {"model", &O::model},
      {"alpha", &O::alpha},
      {"yield_measure", &O::yield_measure},
      {"sigma0", &O::sigma0},
      {"crack_length", &O::crack_length},
      {"sif", &O::sif},
      {"max_events", &O::max_events},
      {"plane_normal", &O::has_plane_normal},  // none: 0
      {"birth", &O::birth},
      {"averaging", &O::averaging},
      {"stress", &O::stress},
      {"crack", &O::crack},
      {"max_new_nodes", &O::max_new_nodes},
      {"contact", &O::contact},
  };
  return members;
}

const std::map<std::string, Member<sunder_solver_options>>& solver_members() {
  using O = sunder_solver_options;
  static const std::map<std::string, Member<O>> members{
      {"backend", &O::backend},        {"route", &O::route},         {"update", &O::update},
      {"precision", &O::precision},    {"tolerance", &O::tolerance}, {"device", &O::device},
      {"prepare", &O::no_preparation},  // the other way round
      {"max_ms", &O::max_ms},
  };
  return members;
}

/// A key's default as its member in C has it.
double in_c(const std::optional<KeyValue>& standard) {
  if (!standard) return 0;
  // Off: of a key that is on by default the member is the other way round.
  if (std::holds_alternative<bool>(*standard)) return 0;
  if (const auto* count = std::get_if<int>(&*standard)) return *count;
  if (const auto* number = std::get_if<double>(&*standard)) return *number;
  EXPECT_EQ(std::get<std::string>(*standard), "auto");
  return SUNDER_BACKEND_AUTO;
}

template <class Owner, class Options>
void expect_defaults(std::span<const MemberKey<Owner>> keys,
                     const std::map<std::string, Member<Options>>& members,
                     const Options& standard) {
  EXPECT_EQ(keys.size(), members.size());
  for (const MemberKey<Owner>& key : keys) {
    SCOPED_TRACE(std::string(key.name));
    const auto found = members.find(std::string(key.name));
    ASSERT_NE(found, members.end()) << "the C interface has no member for this key";
    const double value = std::visit(
        [&](auto member) { return static_cast<double>(standard.*member); }, found->second);
    EXPECT_EQ(value, in_c(key.get(Owner{})));
  }
}

TEST(SceneKeys, HaveTheirDefaultsInC) {
  sunder_fracture_options fracture;
  sunder_fracture_options_init(&fracture);
  expect_defaults(fracture_keys(), fracture_members(), fracture);
  sunder_solver_options solver;
  sunder_solver_options_init(&solver);
  expect_defaults(solver_keys(), solver_members(), solver);
}

class CScene {
 public:
  CScene() { EXPECT_EQ(sunder_scene_create(&scene_), SUNDER_OK); }
  CScene(const CScene&) = delete;
  CScene& operator=(const CScene&) = delete;
  ~CScene() { sunder_scene_destroy(scene_); }
  [[nodiscard]] sunder_scene get() const { return scene_; }

 private:
  sunder_scene scene_ = nullptr;
};

template <class Owner, class Options, class Init, class Set>
void expect_words(std::span<const MemberKey<Owner>> keys,
                  const std::map<std::string, Member<Options>>& members, Init init, Set set) {
  const CScene scene;
  for (const MemberKey<Owner>& key : keys) {
    if (key.type != KeyType::word) continue;
    SCOPED_TRACE(std::string(key.name));
    Options options;
    init(&options);
    int32_t& value = options.*std::get<int32_t Options::*>(members.at(std::string(key.name)));
    const auto words = static_cast<int32_t>(key.words.size());
    value = words - 1;
    EXPECT_EQ(set(scene.get(), &options), SUNDER_OK);
    value = words;
    EXPECT_EQ(set(scene.get(), &options), SUNDER_ERROR_VALUE);
  }
}

/// A word of a material by its number, the last one taken and none beyond.
void expect_words_of_material(std::string_view key, int32_t sunder_material::*member,
                              std::span<const std::string_view> names) {
  SCOPED_TRACE(std::string(key));
  const auto& words = key_words("material", key);
  ASSERT_EQ(words.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(words[i], names[i]);
  const CScene scene;
  sunder_material material = SUNDER_MATERIAL_INIT;
  material.young = 5;
  material.*member = static_cast<int32_t>(names.size()) - 1;
  EXPECT_EQ(sunder_scene_add_material(scene.get(), &material, nullptr), SUNDER_OK);
  material.*member = static_cast<int32_t>(names.size());
  EXPECT_EQ(sunder_scene_add_material(scene.get(), &material, nullptr), SUNDER_ERROR_VALUE);
}

TEST(SceneKeys, MaterialsHaveTheirWordsInC) {
  std::array<std::string_view, 4> laws;
  laws[SUNDER_LAW_LINEAR] = "linear";
  laws[SUNDER_LAW_COROTATED] = "corotated";
  laws[SUNDER_LAW_NEO_HOOKEAN] = "neo-hookean";
  laws[SUNDER_LAW_SAINT_VENANT_KIRCHHOFF] = "saint-venant-kirchhoff";
  expect_words_of_material("law", &sunder_material::law, laws);
  std::array<std::string_view, 2> volumes;
  volumes[SUNDER_VOLUME_ELEMENT] = "element";
  volumes[SUNDER_VOLUME_POOLED] = "pooled";
  expect_words_of_material("volume", &sunder_material::volume, volumes);
}

TEST(SceneKeys, AMaterialOfACallerBeforeVolumeCameHasNone) {
  const CScene scene;
  sunder_material material = SUNDER_MATERIAL_INIT;
  material.young = 5;
  material.volume = 99;
  material.struct_size = offsetof(sunder_material, volume);
  EXPECT_EQ(sunder_scene_add_material(scene.get(), &material, nullptr), SUNDER_OK);
}

TEST(SceneKeys, HaveTheirWordsInC) {
  expect_words(fracture_keys(), fracture_members(), sunder_fracture_options_init,
               sunder_scene_set_fracture);
  expect_words(solver_keys(), solver_members(), sunder_solver_options_init,
               sunder_scene_set_solver);
  EXPECT_EQ(key_words("fracture", "model").at(SUNDER_FRACTURE_P), "P");
}

// A caller compiled before a member came: what it leaves out is the default.
TEST(SceneKeys, OlderCallersLeaveNewOnesOut) {
  const CScene scene;
  sunder_fracture_options options;
  sunder_fracture_options_init(&options);
  options.struct_size = offsetof(sunder_fracture_options, averaging);
  options.averaging = -1;
  EXPECT_EQ(sunder_scene_set_fracture(scene.get(), &options), SUNDER_OK);
}

}  // namespace
}  // namespace sunder::test
