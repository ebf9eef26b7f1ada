// SPDX-License-Identifier: Apache-2.0
// Shared by the kernels of conjugate gradients: vectors have four values a node, dofs that a support
// or a grip holds stay 0.
#include "common.glsl"
#include "reduce.glsl"

const uint kNodeAxes = 7u;  // of a node's word: axes held; above them its group, kHeld: none

bvec3 held_axes(uvec4 dofs) {
  return bvec3(dofs.x == kHeld || (dofs.w & 1u) != 0u, dofs.y == kHeld || (dofs.w & 2u) != 0u,
               dofs.z == kHeld || (dofs.w & 4u) != 0u);
}

dvec3 times(dvec4 row0, dvec4 row1, dvec4 row2, dvec3 v) {
  return dvec3(dot(row0.xyz, v), dot(row1.xyz, v), dot(row2.xyz, v));
}

#ifndef SUNDER_LVP
shared double subgroup_sums[kGroup];
#endif

// Sum over what leaves one result together (reduce.glsl), in a fixed order. `lvp`: kernels of one
// workgroup, or of one for each result, have workgroups of one subgroup.
double part_sum(double value) {
  value = subgroupAdd(value);
#ifndef SUNDER_LVP
  barrier();
  if (subgroupElect()) subgroup_sums[gl_SubgroupID] = value;
  barrier();
  value = subgroup_sums[0];
  for (uint s = 1u; s < gl_NumSubgroups; ++s) value += subgroup_sums[s];
#endif
  return value;
}
