// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "sunder/backend.hpp"

namespace sunder {

/// Runs on `primary` until its device is lost, then on what `replacement` creates, from the last
/// frame on: the event history, the excluded elements and the load are played to it, and the
/// operation that failed is done there.
[[nodiscard]] std::unique_ptr<Backend> with_failover(
    std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> primary,
    std::function<std::unique_ptr<Backend>()> replacement);

}  // namespace sunder
