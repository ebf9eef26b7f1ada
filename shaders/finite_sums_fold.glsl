// SPDX-License-Identifier: Apache-2.0
// What an iteration tells the host, folded over a workgroup.
#include "finite.glsl"

FiniteSums no_sums() { return FiniteSums(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0); }

// Of all invocations; known to each.
FiniteSums folded(FiniteSums of) {
  return FiniteSums(part_sum(of.energy), part_sum(of.viscous), part_sum(of.springs),
                    part_sum(of.residual_squared), part_sum(of.held_squared),
                    part_sum(of.inertia_squared), part_max(of.stress_squared),
                    part_max(of.change_squared), part_sum(of.slope), part_sum(of.s_y),
                    part_sum(of.s_squared), part_sum(of.y_squared));
}
