// SPDX-License-Identifier: Apache-2.0
// The routes and updates whose frames are to allocate nothing.
#pragma once

#include <gtest/gtest.h>

#include "sunder/scene.hpp"

namespace sunder::test {

struct Way {
  const char* name;
  Route route;
  Update update = Update::deferred;
};

inline auto every_way() {
  return ::testing::Values(Way{"Inverse", Route::inverse}, Way{"Condensed", Route::condensed},
                           Way{"Factor", Route::factor},
                           Way{"InverseEager", Route::inverse, Update::eager});
}

}  // namespace sunder::test
