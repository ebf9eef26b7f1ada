// SPDX-License-Identifier: Apache-2.0
// The ONE list of backends. A further backend is one entry in create_backend.cpp.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sunder/backend.hpp"
#include "sunder/pipeline_cache.hpp"

struct sunder_vulkan_host;

namespace sunder {

/// Names that `backend = ...` takes besides "auto".
[[nodiscard]] std::vector<std::string> backend_names();

[[nodiscard]] std::vector<DeviceInfo> devices();
/// Measures each Vulkan device of which no rates are kept by device and driver (`again`: all of
/// them), in under a second each. Plans predict by what is kept, in SUNDER_CACHE_DIR, else in
/// sunder/ of the user's folder for such files, and weigh by it how large an inverse a GPU is to
/// make. Returns a sentence for each device that could not be measured or kept.
[[nodiscard]] std::vector<std::string> measure_devices(bool again);

struct CreatedBackend {
  std::unique_ptr<Backend> backend;
  std::vector<std::string> warnings;  ///< e.g. why "auto" fell back
};

namespace cpu_reference {
class PreparedBodies;
}

/// For create_prepared_backend(): at most so many intact bodies (1 or more), those asked for last.
[[nodiscard]] std::shared_ptr<cpu_reference::PreparedBodies> prepared_bodies(std::size_t most);

/// Creates the backend that the problem's solver options ask for. Throws DeviceError when there is
/// no such backend or device, or when it offers no such route or precision.
/// `cache`: where the host keeps what a device's driver makes of the kernels; one that does not fit
/// the device is ignored, with a warning.
[[nodiscard]] CreatedBackend create_backend(std::shared_ptr<const Problem> problem, Needs needs,
                                            std::shared_ptr<PipelineCache> cache = {});
/// The backend vulkan on a host's own device, which must outlive it (sunder_vulkan.h has the rules;
/// the buffers of `host` are not written to). Throws DeviceError for what is missing there, and
/// where the scene asks for "cpu".
[[nodiscard]] CreatedBackend create_backend_on(std::shared_ptr<const Problem> problem, Needs needs,
                                               const sunder_vulkan_host& host,
                                               std::shared_ptr<PipelineCache> cache = {});
/// As create_backend() by the backend cpu, and no result other by a bit. Problems of one intact
/// stiffness share what is made of it: its order, its factor and the dense inverse (a law of finite
/// deformation and motion: nothing). By any number of threads at once. Throws DeviceError where the
/// scene asks for another backend than "cpu" or "auto".
[[nodiscard]] CreatedBackend create_prepared_backend(
    std::shared_ptr<const Problem> problem, Needs needs,
    std::shared_ptr<cpu_reference::PreparedBodies> prepared);

}  // namespace sunder
