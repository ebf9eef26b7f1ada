// SPDX-License-Identifier: Apache-2.0
// From a body to the same one of another law, crack way or material: what was done to it so far.
#pragma once

#include <map>
#include <string>

#include "app/view/body.hpp"

namespace sunder::app {

struct Carried {
  int elements = 0;          ///< that are gone
  int closed_cracks = 0;     ///< whose faces had opened: they are whole again
  std::map<int, int> grips;  ///< numbers there, by those here
  int grips_let_go = 0;      ///< others: in motion, or no node of theirs could be taken
  bool stepped = false;      ///< a step has brought it to where the other one was

  /// "14 elements stay gone, 2 grips hold on"; empty: there was nothing.
  [[nodiscard]] std::string sentence() const;
};

/// Does to a body that nothing was done to what another one has behind it, by inputs that its hand
/// takes down: elements that have gone are removed, so that cracks are slits without tips; grips
/// take hold of the same nodes at rest, a patch with the shape that it has there, and go where they
/// are; instruments stand as they stand, ramps over; then a step, where there has been one. In
/// motion elements only: it begins at rest. Throws what Simulation throws.
[[nodiscard]] Carried carry_over(const Body& from, Body& to);

}  // namespace sunder::app
