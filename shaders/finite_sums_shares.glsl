// SPDX-License-Identifier: Apache-2.0
// What an iteration tells the host, of a share of all partial results and unknowns, and the pair of L-BFGS
// that it would leave: summed by one workgroup in a fixed order.
#include "finite_sums_fold.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Elements { FiniteElementPartial data[]; } of_elements;
layout(std430, set = 0, binding = 1) readonly buffer Entries { FiniteEntryPartial data[]; } of_entries;
IN_DOUBLES(2, Before, before)
IN_DOUBLES(3, After, after)
IN_DOUBLES(4, Direction, du)
OUT(5, Steps, double, s)
OUT(6, Changes, double, y)
OUT(7, Sums, FiniteSums, sums)
layout(push_constant) uniform Push { FinitePush p; };

// Of so many, what share `which` of `shares` has: from x on, before y.
uvec2 share(uint count, uint which, uint shares) {
  const uint each = (count + shares - 1u) / shares;
  return min(uvec2(which * each, (which + 1u) * each), uvec2(count));
}

FiniteSums sums_of(uint which, uint shares) {
  FiniteSums of = no_sums();
  const uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  const uvec2 elements = share(p.element_parts, which, shares),
              entries = share(p.entry_parts, which, shares),
              unknowns = share(p.unknowns, which, shares);
  for (uint i = elements.x + lane; i < elements.y; i += lanes) {
    const FiniteElementPartial part = of_elements.data[i];
    of.energy += part.energy;
    of.viscous += part.viscous;
    of.stress_squared = max(of.stress_squared, part.stress_squared);
    of.change_squared = max(of.change_squared, part.change_squared);
  }
  for (uint i = entries.x + lane; i < entries.y; i += lanes) {
    const FiniteEntryPartial part = of_entries.data[i];
    of.residual_squared += part.residual_squared;
    of.held_squared += part.held_squared;
    of.inertia_squared += part.inertia_squared;
    of.springs += part.springs;
  }
  for (uint d = unknowns.x + lane; p.part > 0.0LF && d < unknowns.y; d += lanes) {
    const double along = du.data[d], left = before.data[d];
    const double step_ = p.part * along, change = after.data[d] - left;
    s.data[p.slot * p.unknowns + d] = step_;
    y.data[p.slot * p.unknowns + d] = change;
    of.slope += left * along;
    of.s_y += step_ * change;
    of.s_squared += step_ * step_;
    of.y_squared += change * change;
  }
  return folded(of);
}
