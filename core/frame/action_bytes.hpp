// SPDX-License-Identifier: Apache-2.0
// A history as bytes: a mark, the version, the body that it belongs to, the actions, a checksum;
// little-endian whatever the machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "frame/history.hpp"

namespace sunder {

/// Of all that decides what actions lead to: mesh, materials, supports, instruments, fracture,
/// time, route. Two bodies that differ have the same one by chance of 1 to 2^64.
/// `live`: in place of the scene's own word.
[[nodiscard]] std::uint64_t fingerprint(const Problem& problem, const BackendInfo& backend,
                                        bool live);

[[nodiscard]] std::vector<std::uint8_t> to_bytes(
    std::span<const std::shared_ptr<const Action>> actions, std::uint64_t body);
/// Throws InputError where they are damaged, of another version or none of these bodies.
[[nodiscard]] std::vector<std::shared_ptr<const Action>> from_bytes(
    std::span<const std::uint8_t> bytes, std::span<const std::uint64_t> bodies);

}  // namespace sunder
