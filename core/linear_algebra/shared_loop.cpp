// SPDX-License-Identifier: Apache-2.0
#include "linear_algebra/shared_loop.hpp"

#include <algorithm>
#include <thread>

namespace sunder::linear_algebra {

int machine_threads() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

int background_threads() { return std::max(1, machine_threads() / 2); }

}  // namespace sunder::linear_algebra
