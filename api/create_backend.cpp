// SPDX-License-Identifier: Apache-2.0
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder {

std::vector<std::string> backend_names() { return {"cpu"}; }

std::vector<DeviceInfo> devices() { return {cpu_reference::device()}; }

CreatedBackend create_backend(std::shared_ptr<const Problem> problem, Needs needs) {
  if (!problem) throw UsageError("a backend needs a problem");
  const std::string& name = problem->scene().solver.backend;
  if (name == "cpu" || name == "auto") {
    return {cpu_reference::create(std::move(problem), std::move(needs)), {}};
  }
  throw DeviceError("this build has no backend \"" + name + "\"; it has cpu");
}

}  // namespace sunder
