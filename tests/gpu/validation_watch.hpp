// SPDX-License-Identifier: Apache-2.0
// The Khronos validation layer with synchronization validation over every Vulkan instance of a test
// program and of the processes that it starts, whoever creates them and with whatever options.
#pragma once

#include <string>

namespace sunder::test {

/// Turns the layer on through the loader's environment and makes every GoogleTest test fail during
/// which it says anything. Called by main before anything else.
void watch_with_validation();

/// Puts tests/gpu/layer over every instance where SUNDER_TEST_LAYER says what device to make of the
/// one at hand; `validation`: and the validation layer after it. Called by main before anything
/// else.
void choose_layers(bool validation);

/// What the layer has said since the last call: for tests that provoke it.
[[nodiscard]] std::string take_validation_messages();

}  // namespace sunder::test
