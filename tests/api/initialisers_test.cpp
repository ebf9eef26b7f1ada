// SPDX-License-Identifier: Apache-2.0
// SUNDER_..._INIT: the same from C99 and C++, and the same defaults as the functions give.
#include "api/initialisers.h"

#include <gtest/gtest.h>

#include <cstring>

namespace sunder::test {
namespace {

TEST(CInitialisers, AreTheSameInC99AndCpp) {
  const initialised in_cpp = INITIALISED;
  initialised in_c99;
  std::memset(static_cast<void*>(&in_c99), 0xff, sizeof in_c99);
  initialise_in_c99(&in_c99);
  EXPECT_EQ(std::memcmp(&in_cpp, &in_c99, sizeof in_c99), 0);
  EXPECT_EQ(in_c99.step.struct_size, sizeof(sunder_step));
  EXPECT_EQ(in_c99.signals.struct_size, sizeof(sunder_vulkan_signals));
}

template <class T>
void expect_defaults(const T& initial, void (*init)(T*)) {
  T from_function;
  std::memset(static_cast<void*>(&from_function), 0xff, sizeof from_function);
  init(&from_function);
  EXPECT_EQ(initial.struct_size, sizeof(T));
  EXPECT_EQ(std::memcmp(&initial, &from_function, sizeof(T)), 0) << sizeof(T);
}

TEST(CInitialisers, SetTheDefaultsOfTheFunctions) {
  const initialised all = INITIALISED;
  expect_defaults(all.material, sunder_material_init);
  expect_defaults(all.support, sunder_support_init);
  expect_defaults(all.instrument, sunder_instrument_init);
  expect_defaults(all.crack, sunder_preset_crack_init);
  expect_defaults(all.fracture, sunder_fracture_options_init);
  expect_defaults(all.solver, sunder_solver_options_init);
}

}  // namespace
}  // namespace sunder::test
