// SPDX-License-Identifier: Apache-2.0
#include "app/view/shaders/embedded.hpp"

namespace sunder::app::view::shaders {
namespace {

#include "body.frag.h"
#include "body.vert.h"
#include "lips.frag.h"
#include "lips.vert.h"

}  // namespace

std::span<const std::uint32_t> body_vert() { return view_body_vert; }
std::span<const std::uint32_t> body_frag() { return view_body_frag; }
std::span<const std::uint32_t> lips_vert() { return view_lips_vert; }
std::span<const std::uint32_t> lips_frag() { return view_lips_frag; }

}  // namespace sunder::app::view::shaders
