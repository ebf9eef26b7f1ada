#version 460
// SPDX-License-Identifier: Apache-2.0
// Internal forces at the nodes, by ascending element, and the residual of the unknowns: internal and viscous
// forces less the load, with the springs of inertia.
#extension GL_GOOGLE_include_directive : require
#include "finite.glsl"

IN_DOUBLES(0, Corners, corners)
IN_DOUBLES(1, ViscousCorners, viscous_corners)
IN_WORDS(2, First, first)  // of each node
IN_WORDS(3, Around, around)  // 4 * element + corner
layout(std430, set = 0, binding = 4) readonly buffer Entries { uvec2 data[]; } entries;
IN_DOUBLES(5, Target, target)  // force and spring of each unknown, then where springs begin
IN_DOUBLES(6, Nodal, u)
OUT(7, Forces, double, f)  // internal, then viscous
OUT(8, Residual, double, r)
OUT(9, Partials, FiniteEntryPartial, partials)
layout(push_constant) uniform Push { FinitePush p; };

void main() {
  const uint i = invocation();
  double residual = 0, held = 0, inertia = 0, springs = 0;
  if (i < p.entries) {
    const uint node = i / 3u, axis = i % 3u;
    double sum = 0, viscous = 0;
    for (uint k = first.data[node]; k < first.data[node + 1u]; ++k) {
      const uint at = 3u * around.data[k] + axis;
      sum += corners.data[at];
      if (p.viscous > 0.0LF) viscous += viscous_corners.data[at];
    }
    f.data[i] = sum;
    f.data[p.entries + i] = viscous;
    const uvec2 entry = entries.data[i];
    const uint d = entry.x;
    if (d == kHeld) {
      held = sum * sum;
    } else {
      const double load = target.data[d], spring = target.data[p.unknowns + d];
      double left = (sum + viscous) - load;
      if ((entry.y & kFiniteFrozen) == 0u) {
        if ((entry.y & kFiniteGripped) != 0u) held = left * left;
        const double way = u.data[i] - target.data[2u * p.unknowns + i], force = spring * way;
        left += force;
        inertia = force * force;
        springs = 0.5LF * force * way - load * u.data[i];
      }
      residual = entry.y == 0u ? left : 0.0LF;
      r.data[d] = residual;
    }
  }
  residual = part_sum(residual * residual);
  held = part_sum(held);
  inertia = part_sum(inertia);
  springs = part_sum(springs);
  if (leads_part()) partials.data[part()] = FiniteEntryPartial(residual, held, inertia, springs);
}
