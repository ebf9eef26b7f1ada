// SPDX-License-Identifier: Apache-2.0
// How far the interfaces of a body have parted.
#pragma once

#include <span>
#include <vector>

#include "sunder/interfaces.hpp"
#include "sunder/report.hpp"

namespace sunder {

struct PartedInterface {
  double area = 0;    ///< of its elements that are destroyed [mm^2]
  double energy = 0;  ///< that those took which parted by its law [N mm]
};
/// Of each interface, by the rows of a run.
[[nodiscard]] std::vector<PartedInterface> parted_interfaces(
    const Interfaces& all, std::span<const DestroyedElement> rows);

}  // namespace sunder
