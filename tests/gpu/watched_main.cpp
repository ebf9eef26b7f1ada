// SPDX-License-Identifier: Apache-2.0
// main() of the test programs that touch Vulkan.
#include <gtest/gtest.h>

#include "validation_watch.hpp"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  sunder::test::watch_with_validation();
  return RUN_ALL_TESTS();
}
