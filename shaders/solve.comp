#version 460
// SPDX-License-Identifier: Apache-2.0
// u = sum of column_j c_j, from unknowns to nodes: the whole solve of a frame whose loads and damage
// lie on exact columns. Reads n values a column.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Matrix, matrix)
IN_DVEC4(1, Coefficients, coefficients)  // padded with zeros to four
IN_UVEC4(2, Position, position)          // of each unknown among the nodes' values
OUT(3, Nodal, double, u)
layout(push_constant) uniform Push { SolvePush p; };

void main() {
  const uint pack = invocation();
  dvec4 sum = dvec4(0);
  uint at = pack;
  for (uint j = 0u; j < p.columns; j += 4u) {
    const dvec4 c = DVEC4(coefficients, j / 4u);
    sum += DVEC4(matrix, at) * c.x;
    sum += DVEC4(matrix, at + p.packs) * c.y;
    sum += DVEC4(matrix, at + 2u * p.packs) * c.z;
    sum += DVEC4(matrix, at + 3u * p.packs) * c.w;
    at += 4u * p.packs;
  }
  const uvec4 to = UVEC4(position, pack);
  u.data[to.x] = sum.x;
  u.data[to.y] = sum.y;
  u.data[to.z] = sum.z;
  u.data[to.w] = sum.w;
}
