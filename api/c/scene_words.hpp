// SPDX-License-Identifier: Apache-2.0
// Enumerations of the C interface that a key of a scene states by words.
#pragma once

#include "c/failure.hpp"
#include "c/names.hpp"
#include "sunder/scene_keys.hpp"

namespace sunder::c {

/// A value of an enumeration that has as many as the scene's key has words.
template <class Enum>
Enum word(std::int32_t value, const char* table, const char* key, const char* what = nullptr) {
  const auto count = static_cast<std::int32_t>(key_words(table, key).size());
  return choice<Enum>(value, count, what ? what : key);
}

}  // namespace sunder::c
