// SPDX-License-Identifier: Apache-2.0
#include "app/system/handle.hpp"

#include <unistd.h>

namespace sunder::app::system {

bool Handle::close(std::intptr_t value) noexcept { return ::close(static_cast<int>(value)) == 0; }

}  // namespace sunder::app::system
