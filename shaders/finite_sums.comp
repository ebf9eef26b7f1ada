#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: what an iteration tells the host, and the pair of L-BFGS that it would leave.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Elements { FiniteElementPartial data[]; } of_elements;
layout(std430, set = 0, binding = 1) readonly buffer Entries { FiniteEntryPartial data[]; } of_entries;
IN_DOUBLES(2, Before, before)
IN_DOUBLES(3, After, after)
IN_DOUBLES(4, Direction, du)
OUT(5, Steps, double, s)
OUT(6, Changes, double, y)
OUT(7, Sums, FiniteSums, sums)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  FiniteSums of = FiniteSums(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
  const uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  for (uint i = lane; i < p.element_parts; i += lanes) {
    const FiniteElementPartial part = of_elements.data[i];
    of.energy += part.energy;
    of.viscous += part.viscous;
    of.stress_squared = max(of.stress_squared, part.stress_squared);
    of.change_squared = max(of.change_squared, part.change_squared);
  }
  for (uint i = lane; i < p.entry_parts; i += lanes) {
    const FiniteEntryPartial part = of_entries.data[i];
    of.residual_squared += part.residual_squared;
    of.held_squared += part.held_squared;
    of.inertia_squared += part.inertia_squared;
    of.springs += part.springs;
  }
  for (uint d = lane; p.part > 0.0LF && d < p.unknowns; d += lanes) {
    const double along = du.data[d], left = before.data[d];
    const double step_ = p.part * along, change = after.data[d] - left;
    s.data[p.slot * p.unknowns + d] = step_;
    y.data[p.slot * p.unknowns + d] = change;
    of.slope += left * along;
    of.s_y += step_ * change;
    of.s_squared += step_ * step_;
    of.y_squared += change * change;
  }
  of = FiniteSums(part_sum(of.energy), part_sum(of.viscous), part_sum(of.springs),
                  part_sum(of.residual_squared), part_sum(of.held_squared),
                  part_sum(of.inertia_squared), part_max(of.stress_squared),
                  part_max(of.change_squared), part_sum(of.slope), part_sum(of.s_y),
                  part_sum(of.s_squared), part_sum(of.y_squared));
  if (lane == 0u) sums.data[0] = of;
}
