#version 460
// SPDX-License-Identifier: Apache-2.0
// One workgroup: r^T M r, its ratio to the one before, and whether to go on. At the end it sets the
// size of all further dispatches to 0.
#extension GL_GOOGLE_include_directive : require
#include "cg.glsl"

IN_DVEC4(0, RzPartial, rz_partial)
IN_DVEC4(1, Terms, terms)  // of y^T w
INOUT(2, State, CgState, state)
OUT(3, Arguments, uint, arguments)
layout(push_constant) uniform Push { CgPush p; };

// What a sum of known solutions may leave, by the target: each was solved to that of its own load.
const double kOfASum = 100;

void start(double rz) {
  state.data[0].target = max(rz, state.data[0].energy) * p.reduction;
  state.data[0].iterations = 0u;
  state.data[0].broken = rz >= 0 ? 0u : 1u;  // NaN included
  for (uint i = 0u; i < 3u * kCgSizes; ++i) arguments.data[i] = 1u;
}

void main() {
  double sum = 0;
  for (uint i = gl_LocalInvocationID.x; i < p.partials; i += gl_WorkGroupSize.x) {
    const dvec4 of = DVEC4(rz_partial, i);
    sum += (of.x + of.y) + (of.z + of.w);
  }
  for (uint i = gl_LocalInvocationID.x; 4u * i < p.rigid_terms; i += gl_WorkGroupSize.x) {
    const dvec4 of = DVEC4(terms, i);
    sum += (of.x + of.y) + (of.z + of.w);
  }
  const double rz = part_sum(sum);
  if (gl_LocalInvocationID.x != 0u) return;
  if (p.first == 1u) {
    start(rz);
  } else {
    state.data[0].ratio = rz / state.data[0].rz;
    state.data[0].iterations += 1u;
    if (!(rz >= 0) || isinf(rz)) state.data[0].broken = 1u;
  }
  state.data[0].rz = rz;
  const double enough = p.first == 1u && p.guess == 2u ? kOfASum : 1.0LF;
  const bool run = state.data[0].broken == 0u && rz > enough * state.data[0].target;
  state.data[0].running = run ? 1u : 0u;
  arguments.data[3u * kCgByNode] = run ? p.groups : 0u;
  arguments.data[3u * kCgByGroup] = run ? p.rigid_groups : 0u;
  arguments.data[3u * kCgBySolve] = run ? p.rigid_solves : 0u;
  arguments.data[3u * kCgByOne] = run ? 1u : 0u;
  arguments.data[3u * kCgByElement] = run ? p.elements : 0u;
  arguments.data[3u * kCgByAggregate] = run ? p.rigid_aggregates : 0u;
  arguments.data[3u * kCgByRow] = run ? p.rigid_rows : 0u;
}
