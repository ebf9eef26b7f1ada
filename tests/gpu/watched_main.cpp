// SPDX-License-Identifier: Apache-2.0
// main() of the test programs that touch Vulkan. SUNDER_WITHOUT_VALIDATION is for sanitizers alone:
// the layer leaks by itself.
#include <gtest/gtest.h>

#include <cstdlib>

#include "validation_watch.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  setenv("SUNDER_CACHE_DIR", "", 0);  // no test leaves rates in the user's folder
  const bool validation = !std::getenv("SUNDER_WITHOUT_VALIDATION");
  sunder::test::choose_layers(validation);
  if (validation) sunder::test::watch_with_validation();
  return RUN_ALL_TESTS();
}
