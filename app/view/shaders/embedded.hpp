// SPDX-License-Identifier: Apache-2.0
// The SPIR-V of the renderer, compiled at build time and part of the program.
#pragma once

#include <cstdint>
#include <span>

namespace sunder::app::view::shaders {

[[nodiscard]] std::span<const std::uint32_t> body_vert();
[[nodiscard]] std::span<const std::uint32_t> body_frag();
[[nodiscard]] std::span<const std::uint32_t> lips_vert();
[[nodiscard]] std::span<const std::uint32_t> lips_frag();

}  // namespace sunder::app::view::shaders
