// SPDX-License-Identifier: Apache-2.0
// SUNDER_..._INIT: the defaults that the functions give, in results nothing but the size.
#include "api/initialisers.h"

#include <gtest/gtest.h>

#include <cstring>

namespace sunder::test {
namespace {

template <class T>
void expect_only_size(const T& initial) {
  T zeroed{};
  zeroed.struct_size = sizeof(T);
  EXPECT_EQ(std::memcmp(&initial, &zeroed, sizeof(T)), 0) << sizeof(T);
}

TEST(CInitialisers, StateTheSizeAndNothingElseOfResults) {
  const initialised all = INITIALISED;
  expect_only_size(all.device);
  expect_only_size(all.engine);
  expect_only_size(all.callbacks);
  expect_only_size(all.step);
  expect_only_size(all.body);
  expect_only_size(all.event);
  expect_only_size(all.grown);
  expect_only_size(all.tip);
  expect_only_size(all.interface_state);
  expect_only_size(all.felt);
  expect_only_size(all.frame);
  expect_only_size(all.host);
  expect_only_size(all.display);
  expect_only_size(all.signals);
  expect_only_size(all.drawn);
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
  expect_defaults(all.fibres, sunder_fibres_init);
  expect_defaults(all.fracture, sunder_fracture_options_init);
  expect_defaults(all.solver, sunder_solver_options_init);
}

}  // namespace
}  // namespace sunder::test
