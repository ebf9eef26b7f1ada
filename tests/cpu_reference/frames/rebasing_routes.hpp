// SPDX-License-Identifier: Apache-2.0
// The routes that make new bases beside the frames, without and with grips.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sunder/scene.hpp"

namespace sunder::test {

struct RebasingRoute {
  const char* name;
  Route route;
  bool grips;
};

inline auto rebasing_routes() {
  return ::testing::Values(RebasingRoute{"Inverse", Route::inverse, false},
                           RebasingRoute{"InverseGrips", Route::inverse, true},
                           RebasingRoute{"Condensed", Route::condensed, false},
                           RebasingRoute{"CondensedGrips", Route::condensed, true},
                           RebasingRoute{"Factor", Route::factor, false},
                           RebasingRoute{"FactorGrips", Route::factor, true});
}

inline std::string name_of(const ::testing::TestParamInfo<RebasingRoute>& tested) {
  return tested.param.name;
}

}  // namespace sunder::test
