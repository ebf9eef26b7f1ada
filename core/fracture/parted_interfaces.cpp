// SPDX-License-Identifier: Apache-2.0
#include "sunder/parted_interfaces.hpp"

namespace sunder {

std::vector<PartedInterface> parted_interfaces(const Interfaces& all,
                                               std::span<const DestroyedElement> rows) {
  std::vector<PartedInterface> parted(all.layers().size());
  for (const DestroyedElement& row : rows) {
    if (row.lives || row.element == kNone || !all.has(row.element)) continue;
    PartedInterface& of =
        parted[static_cast<std::size_t>(&all.layer(row.element) - all.layers().data())];
    of.area += all.area(row.element);
    of.energy += row.energy.value_or(0);
  }
  return parted;
}

}  // namespace sunder
