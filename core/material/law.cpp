// SPDX-License-Identifier: Apache-2.0
#include "material/law.hpp"

#include <array>

#include "material/corotated.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"

namespace sunder {

std::span<const Law* const> laws() {
  static constexpr std::array kLaws{&kLinear, &kCorotated, &kNeoHookean, &kSaintVenantKirchhoff};
  return kLaws;
}

const Law* find_law(std::string_view name) {
  for (const Law* law : laws()) {
    if (law->name == name) return law;
  }
  return nullptr;
}

}  // namespace sunder
