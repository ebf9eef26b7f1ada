// SPDX-License-Identifier: Apache-2.0
// Every key of a scene, one row each. The reader, the rows of docs/interface.md, the fuzzer's
// dictionary and the words and defaults of the C interface follow from it: a new key is a row, the
// member that it fills, and the code that uses the member.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sunder/scene.hpp"

namespace sunder {

/// What a key takes; for each the reader has one function and one sentence of refusal.
enum class KeyType {
  text,
  number,
  integer,
  boolean,
  word,    ///< one of the key's words
  vector,  ///< [x, y, z]
  points,  ///< two of them
  curve,   ///< two or more
  range,   ///< two numbers
  ids,     ///< of nodes or elements
  texts,
  table,
  tables,
  nodes  ///< no key: the keys of table "nodes" stand here
};

struct SceneKey {
  std::string_view table;  ///< "": the scene itself; "nodes": what selects nodes
  std::string_view name;
  KeyType type = KeyType::text;
  std::string_view meaning;        ///< with its unit; Markdown
  std::string_view wrong;          ///< values that are wrong or odd, and what happens then
  std::vector<std::string> words;  ///< of KeyType::word, in the order of the C++ and C values
  std::string standard;            ///< what stands for a key left out, as a scene would write it
  bool required = false;
  int least = 0;  ///< of an integer
};

using KeyValue = std::variant<bool, int, double, std::string, Vec3>;  ///< a word: its place

/// A key that fills one member of an Owner and does nothing else.
template <class Owner>
struct MemberKey : SceneKey {
  std::optional<KeyValue> (*get)(const Owner&) = nullptr;
  void (*set)(Owner&, const KeyValue&) = nullptr;
};

[[nodiscard]] std::span<const MemberKey<Material>> material_keys();
[[nodiscard]] std::span<const MemberKey<FractureOptions>> fracture_keys();
[[nodiscard]] std::span<const MemberKey<SolverOptions>> solver_keys();
[[nodiscard]] std::span<const MemberKey<Scene>> time_keys();
[[nodiscard]] std::span<const MemberKey<Scene>> load_keys();
/// But for `damping`, which fills two members.
[[nodiscard]] std::span<const MemberKey<Dynamics>> dynamics_keys();

/// All of them, those above included, in the order of the document.
[[nodiscard]] const std::vector<SceneKey>& scene_keys();

/// The names that a table takes, in order; "nodes" spelled out.
[[nodiscard]] std::vector<std::string> key_names(std::string_view table);

/// The words of a key; none where there is no such key.
[[nodiscard]] const std::vector<std::string>& key_words(std::string_view table,
                                                        std::string_view name);

}  // namespace sunder
