// SPDX-License-Identifier: Apache-2.0
// The ONE list of backends. A further backend is one entry in create_backend.cpp.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder {

/// A device on which a backend can run, as `sunder devices` lists it.
struct DeviceInfo {
  std::string backend;     ///< "cpu", "vulkan"
  int index = 0;           ///< among the backend's devices
  std::string name;        ///< marketing name
  std::string driver;
  std::string precisions;  ///< "fp64", "fp32 fp64", ...
  std::string limits;      ///< one line: memory, largest buffer, threads
  bool chosen = false;     ///< by backend = "auto"
  std::string why;         ///< why it is chosen, or why not
};

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
