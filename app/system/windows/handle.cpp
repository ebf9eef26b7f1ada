// SPDX-License-Identifier: Apache-2.0
#include "app/system/handle.hpp"

#include "app/system/windows/handle.hpp"

namespace sunder::app::system {

bool Handle::close(std::intptr_t value) noexcept { return CloseHandle(handle_of(value)) != 0; }

}  // namespace sunder::app::system
