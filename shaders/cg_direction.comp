#version 460
// SPDX-License-Identifier: Apache-2.0
// p = M r + (r^T M r of now / r^T M r of before) p with M r = z + Z w (rigid_space.hpp); first: p = M r,
// x = 0.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_DVEC4(1, Z, z)
IN_DVEC4(2, W, w)  // of each group: shift, turn
IN_UVEC4(3, Modes, modes)  // place in the group, fp32; axes held and number of the group
IN_DVEC4(4, PBefore, before)  // the same memory as p; each invocation its own value
OUT(5, P, dvec4, direction)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = invocation();
  const uvec4 mode = UVEC4(modes, n);
  const bool loose = mode.w == kHeld;
  const uint group = loose ? 0u : mode.w / (kNodeAxes + 1u);
  const dvec3 shift = DVEC4(w, 2u * group).xyz, turn = DVEC4(w, 2u * group + 1u).xyz;
  const dvec3 moved = shift + cross(turn, dvec3(uintBitsToFloat(mode.xyz)));
  const bvec3 none = bvec3(loose || (mode.w & 1u) != 0u, loose || (mode.w & 2u) != 0u,
                           loose || (mode.w & 4u) != 0u);
  const dvec3 m_r = DVEC4(z, n).xyz + mix(moved, dvec3(0), none);
  const dvec3 next = m_r + state.data[0].ratio * DVEC4(before, n).xyz;
  STORE_THREE(direction.data[n], p.first == 1u ? m_r : next);
}
