// SPDX-License-Identifier: Apache-2.0
// Shared by the kernels of conjugate gradients: vectors have four values a node, dofs that a support
// or a grip holds stay 0.
#include "common.glsl"

dvec4 free_part(dvec3 v, uvec4 dofs) {
  return dvec4(dofs.x == kHeld || (dofs.w & 1u) != 0u ? 0.0LF : v.x,
               dofs.y == kHeld || (dofs.w & 2u) != 0u ? 0.0LF : v.y,
               dofs.z == kHeld || (dofs.w & 4u) != 0u ? 0.0LF : v.z, 0.0LF);
}

const uint kRigidTerms = 6u * kRigidGroups;  // where terms of y^T w begin, behind w

shared double group_sums[kGroup];

// Sum over the workgroup in a fixed order; every invocation gets it.
double group_sum(double value) {
  const uint lane = gl_LocalInvocationID.x;
  barrier();
  group_sums[lane] = value;
  for (uint half_ = kGroup / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (lane < half_) group_sums[lane] += group_sums[lane + half_];
  }
  barrier();
  return group_sums[0];
}
