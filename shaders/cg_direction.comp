#version 460
// SPDX-License-Identifier: Apache-2.0
// p = M r + (r^T M r of now / r^T M r of before) p with M r = z + Z w (rigid_space.hpp); first: p = M r,
// x = 0.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

layout(std430, set = 0, binding = 0) readonly buffer State { CgState data[]; } state;
IN_REAL4(1, Z, z)
IN_DVEC4(2, W, w)  // of each group: shift, turn
IN_UVEC4(3, Modes, modes)  // place in the group, fp32; axes held and number of the group
IN_REAL4(4, PBefore, before)  // the same memory as p; each invocation its own value
OUT_REAL4(5, P, direction)
layout(push_constant) uniform Push { CgPush p; };

void main() {
  const uint n = gl_GlobalInvocationID.x;
  const uvec4 mode = UVEC4(modes, n);
  const bool loose = mode.w == kHeld;
  const uint group = loose ? 0u : mode.w / (kNodeAxes + 1u);
  const REAL3 shift = REAL3(DVEC4(w, 2u * group).xyz), turn = REAL3(DVEC4(w, 2u * group + 1u).xyz);
  const REAL3 moved = shift + cross(turn, REAL3(uintBitsToFloat(mode.xyz)));
  const bvec3 none = bvec3(loose || (mode.w & 1u) != 0u, loose || (mode.w & 2u) != 0u,
                           loose || (mode.w & 4u) != 0u);
  const REAL3 m_r = LOAD_REAL4(z, n).xyz + mix(moved, REAL3(0), none);
  const REAL3 next = m_r + REAL(state.data[0].ratio) * LOAD_REAL4(before, n).xyz;
  direction.data[n] = stored(REAL4(p.first == 1u ? m_r : next, 0));
}
