#version 460
// SPDX-License-Identifier: Apache-2.0
// A step of the forces of damage x by the small matrices (core/solver/damage_solver.hpp), of which
// each is symmetric: workgroups have some rows, and invocations of a row a share of its columns.
//   kStep 0: x = [T S] [d; p]
//         1: v = p + G x, u in B
//         2: lack = D v - x, nothing where only grips act
//         3: g = G lack, and what is missing of the grips' displacement, h = d - v
//         4: x += lack + [T S] [h; g]; energy lack^T g + g^T S g of what was lacking
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "reduce.glsl"

layout(constant_id = 2) const uint kStep = 0u;

IN_DOUBLES(0, Compliance, g)
IN_DOUBLES(1, Stiffness, d)
IN_DOUBLES(2, Forces, ts)      // columns of T, then of S
IN_DOUBLES(3, Given, given)    // d, then p
IN_WORDS(4, Facts, facts)      // columns of the grips; then of each column, whether only grips act on it
INOUT(5, State, double, state)  // x, v, lack, then h and g
OUT(6, Found, double, found)   // x, then energies by workgroups
layout(push_constant) uniform Push { DamagePush p; };

#ifdef SUNDER_LVP
#define kRows gl_WorkGroupSize.x
double folded(double value) { return value; }
double sum_of_rows(double value) { return subgroupAdd(value); }
#else
const uint kRows = kDamageRows;
shared double values[kClosingGroup];

double folded(double value) {
  const uint lane = gl_LocalInvocationID.x;
  barrier();
  values[lane] = value;
  barrier();
  double sum = values[lane % kRows];
  for (uint at = lane % kRows + kRows; at < gl_WorkGroupSize.x; at += kRows) sum += values[at];
  return sum;
}

double sum_of_rows(double value) {
  const uint lane = gl_LocalInvocationID.x;
  barrier();
  values[lane] = value;
  barrier();
  double sum = values[0];
  for (uint at = 1u; at < kRows; ++at) sum += values[at];
  return sum;
}
#endif

void main() {
  const uint lane = gl_LocalInvocationID.x;
  const uint row = workgroup() * kRows + lane % kRows, slice = lane / kRows;
  const uint slices = gl_WorkGroupSize.x / kRows;
  const uint x = row, v = p.rows + row, lack = 2u * p.rows + row, missing = 3u * p.rows;
  double sum = 0, of_grips = 0;
  if (row < p.columns) {
    if (kStep == 0u || kStep == 4u) {
      for (uint j = slice; j < p.grips; j += slices) {
        of_grips += ts.data[j * p.rows + row] * (kStep == 0u ? given.data[j] : state.data[missing + j]);
      }
    }
    const uint first = kStep == 1u ? 0u : kStep == 2u ? p.rows : 2u * p.rows;
    for (uint j = slice; j < p.columns; j += slices) {
      const uint at = j * p.rows + row;
      if (kStep == 0u) {
        sum += ts.data[p.grips * p.rows + at] * given.data[p.grips + j];
      } else if (kStep == 4u) {
        sum += ts.data[p.grips * p.rows + at] * state.data[missing + p.grips + j];
      } else if (kStep == 2u) {
        sum += d.data[at] * state.data[first + j];
      } else {
        sum += g.data[at] * state.data[first + j];
      }
    }
  }
  sum = folded(sum);
  if (kStep == 0u || kStep == 4u) of_grips = folded(of_grips);
  double energy = 0;
  if (slice == 0u && row < p.columns) {
    if (kStep == 0u) {
      state.data[x] = of_grips + sum;
      found.data[row] = of_grips + sum;
    } else if (kStep == 1u) {
      state.data[v] = given.data[p.grips + row] + sum;
    } else if (kStep == 2u) {
      state.data[lack] = facts.data[p.grips + row] != 0u ? 0.0 : sum - state.data[x];
    } else if (kStep == 3u) {
      state.data[missing + p.grips + row] = sum;
    } else {
      const double lacking = state.data[lack], of_lack = state.data[missing + p.grips + row];
      energy = lacking * of_lack + of_lack * sum;
      const double now = state.data[x] + (lacking + (of_grips + sum));
      state.data[x] = now;
      found.data[row] = now;
    }
  }
  if (kStep == 3u && slice == 0u && row < p.grips) {
    state.data[missing + row] = given.data[row] - state.data[p.rows + facts.data[row]];
  }
  if (kStep == 4u) {
    energy = sum_of_rows(energy);
    if (lane == 0u) found.data[p.energies + workgroup()] = energy;
  }
}
