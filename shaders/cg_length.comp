#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: a = r^T M r / p^T q; first: a = r^T p / p^T q, and the energy of the first guess: of
// u + a p with p = u, or of all a p so far where each p is a solution that is known and K keeps them
// apart.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_DVEC4(0, PqPartial, pq_partial)
IN_DVEC4(1, RpPartial, rp_partial)
INOUT(2, State, CgState, state)
layout(push_constant) uniform Push { CgPush p; };

void start(double pq, double rp) {
  const bool sound = pq > 0 && !isinf(pq) && !isnan(rp) && !isinf(rp);  // no guess: pq = 0
  const double a = sound ? rp / pq : 0.0LF;
  state.data[0].length_ = a;
  const bool known = p.guess == 2u;
  const double before = known && p.known > 0u ? state.data[0].energy : 0.0LF;
  const double share = known ? a : 1.0LF + a;
  state.data[0].energy = before + (sound ? share * share * pq : 0.0LF);
}

void main() {
  double pq_sum = 0, rp_sum = 0;
  for (uint i = gl_LocalInvocationID.x; i < p.partials; i += gl_WorkGroupSize.x) {
    const dvec4 of = DVEC4(pq_partial, i);
    pq_sum += (of.x + of.y) + (of.z + of.w);
    if (p.first == 0u) continue;
    const dvec4 along = DVEC4(rp_partial, i);
    rp_sum += (along.x + along.y) + (along.z + along.w);
  }
  const double pq = part_sum(pq_sum);
  const double rp = part_sum(rp_sum);
  if (gl_LocalInvocationID.x != 0u) return;
  if (p.first == 1u) {
    start(pq, rp);
    return;
  }
  // A direction that K does not take as positive ends the iteration; NaN included.
  const bool sound = pq > 0 && !isinf(pq);
  state.data[0].length_ = sound ? state.data[0].rz / pq : 0.0LF;
  state.data[0].broken = sound ? 0u : 1u;
}
