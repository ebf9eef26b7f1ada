// SPDX-License-Identifier: Apache-2.0
// r = f - K u over the unknowns (stiffness_rows.glsl). At a gripped dof f - K u is minus the grip's
// reaction, and r = 0.
// SUNDER_POOLED: patches of pooled volume add their forces.
#include "common.glsl"
#include "reduce.glsl"

IN_DVEC4(0, Nodal, u)
IN_UVEC4(3, Dofs, dofs)      // x, y, z; w: gripped axes as bits
IN_DVEC4(4, Load, load)      // of each node
OUT(5, Balance, dvec4, balance)     // f - K u of each node
OUT(6, Residual, double, residual)  // r of each unknown
OUT(7, NodePartials, NodePartial, partials)
#define SUNDER_ROWS_BINDING 1
#define SUNDER_ROWS_OF(j) DVEC4(u, j).xyz
#include "stiffness_rows.glsl"
#ifdef SUNDER_POOLED
#define SUNDER_PATCH_BINDING 8
#include "patch_forces.glsl"
#endif

#ifndef SUNDER_LVP
shared dvec3 subgroup_sums[kGroup];
#endif

void leave(dvec3 sums) {
  sums = dvec3(subgroupAdd(sums.x), subgroupAdd(sums.y), subgroupMax(sums.z));
#ifndef SUNDER_LVP
  if (subgroupElect()) subgroup_sums[gl_SubgroupID] = sums;
  barrier();
  sums = subgroup_sums[0];
  for (uint s = 1u; s < gl_NumSubgroups; ++s) {
    sums = dvec3(sums.xy + subgroup_sums[s].xy, max(sums.z, subgroup_sums[s].z));
  }
#endif
  if (leads_part()) partials.data[part()] = NodePartial(sums.x, sums.y, sums.z, 0.0LF);
}

void main() {
  const uint n = invocation(), slice = workgroup();
  const dvec3 own = DVEC4(u, n).xyz;
  dvec3 k_u = stiffness_row(slice, own);
#ifdef SUNDER_POOLED
  k_u += force_of_patches(slice);
#endif
  const uvec4 dof = UVEC4(dofs, n);
  const dvec3 gap = DVEC4(load, n).xyz - k_u;
  balance.data[n] = dvec4(gap, 0);
  // Free squared, held squared, the largest displacement.
  dvec3 sums = dvec3(0, 0, max(abs(own.x), max(abs(own.y), abs(own.z))));
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    const bool held = dof[axis] == kHeld, gripped = (dof.w >> axis & 1u) != 0u;
    const double squared = held ? 0.0LF : gap[axis] * gap[axis];
    sums.xy += dvec2(gripped ? 0.0LF : squared, gripped ? squared : 0.0LF);
    if (!held) residual.data[dof[axis]] = gripped ? 0.0LF : gap[axis];
  }
  leave(sums);
}
