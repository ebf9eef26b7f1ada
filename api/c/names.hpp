// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sunder/sunder.h"

namespace sunder::c {

[[nodiscard]] inline sunder_backend backend_number(const std::string& name) {
  if (name == "cpu") return SUNDER_BACKEND_CPU;
  return name == "vulkan" ? SUNDER_BACKEND_VULKAN : SUNDER_BACKEND_AUTO;
}

[[nodiscard]] inline const char* backend_name(sunder_backend backend) {
  if (backend == SUNDER_BACKEND_CPU) return "cpu";
  return backend == SUNDER_BACKEND_VULKAN ? "vulkan" : "auto";
}

}  // namespace sunder::c
