// SPDX-License-Identifier: Apache-2.0
// Shared by the kernels of conjugate gradients, which iterate in fp32 or fp64 (REAL); sums, the scalars of an
// iteration and the second level of the preconditioner are fp64 in both. Vectors have four values a
// node; dofs that a support or a grip holds stay 0.
#extension GL_ARB_gpu_shader_int64 : enable
#include "common.glsl"
#include "reduce.glsl"

// lavapipe stores lane by lane: two floats at once as a 64-bit word.
#if defined(SUNDER_LVP) && !defined(SUNDER_FP64)
#define OUT_REAL4(b, Block, name) OUT(b, Block, u64vec2, name)
u64vec2 stored(vec4 v) {
  return u64vec2(packUint2x32(floatBitsToUint(v.xy)), packUint2x32(floatBitsToUint(v.zw)));
}
#else
#define OUT_REAL4(b, Block, name) OUT(b, Block, REAL4, name)
REAL4 stored(REAL4 v) { return v; }
#endif

const uint kNodeAxes = 7u;  // of a node's word: axes held; above them its group, kHeld: none

bvec3 held_axes(uvec4 dofs) {
  return bvec3(dofs.x == kHeld || (dofs.w & 1u) != 0u, dofs.y == kHeld || (dofs.w & 2u) != 0u,
               dofs.z == kHeld || (dofs.w & 4u) != 0u);
}

REAL3 times(REAL4 row0, REAL4 row1, REAL4 row2, REAL3 v) {
  return REAL3(dot(row0.xyz, v), dot(row1.xyz, v), dot(row2.xyz, v));
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
