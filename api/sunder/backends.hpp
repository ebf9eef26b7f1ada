// SPDX-License-Identifier: Apache-2.0
// The ONE list of backends. A further backend is one entry in create_backend.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder {

/// Names that `backend = ...` takes besides "auto".
[[nodiscard]] std::vector<std::string> backend_names();

[[nodiscard]] std::vector<DeviceInfo> devices();

struct CreatedBackend {
  std::unique_ptr<Backend> backend;
  std::vector<std::string> warnings;  ///< e.g. why "auto" fell back
};

/// Creates the backend that the problem's solver options ask for. Throws DeviceError when there is
/// no such backend or device, or when it offers no such route or precision.
[[nodiscard]] CreatedBackend create_backend(std::shared_ptr<const Problem> problem, Needs needs);

}  // namespace sunder
