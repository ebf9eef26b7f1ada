// SPDX-License-Identifier: Apache-2.0
// What a body at finite deformation is to the kernels, element by element, as they read it
// (shaders/layout.h).
#pragma once

#include <cstdint>
#include <vector>

#include "solver/resting_body.hpp"

namespace sunder::gpu {

/// Four nodes an element.
[[nodiscard]] std::vector<std::uint32_t> corners_of(const Problem& problem);
/// kFiniteShape numbers an element.
[[nodiscard]] std::vector<double> shapes_of(const Problem& problem);
/// kFiniteFibres numbers an element; none where no element has any.
[[nodiscard]] std::vector<double> fibres_of(const Problem& problem);
/// Elements of each patch of pooled volume, and where those of each begin.
struct Patches {
  std::vector<std::uint32_t> first{0}, elements;
};
[[nodiscard]] Patches patches_of(const fem::HyperelasticBody& body);
/// Bits, law and patch of each element. Throws DeviceError for a law that the kernels do not know.
[[nodiscard]] std::vector<std::uint32_t> facts_of(const solver::RestingBody& body);

}  // namespace sunder::gpu
