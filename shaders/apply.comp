#version 460
// SPDX-License-Identifier: Apache-2.0
// partial[chunk] = sum of X(:, column_j) c_j over the chunk's entries: u = X f for few loaded dofs.
// Sums in fp64 whatever X is stored in (or of two floats). Reads n values per entry.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_REAL4(0, Matrix, matrix)
IN_UVEC4(1, Entries, entries)
INOUT(2, Partial, WIDE4, partial)
layout(push_constant) uniform Push { ApplyPush p; };
#include "lower.glsl"

void main() {
  const uint pack = invocation();
  const uint first = p.first + gl_WorkGroupID.y * kChunk;
  const uint last = min(first + kChunk, p.last);
  const uint to = (p.partial + gl_WorkGroupID.y) * p.packs + pack;
  WIDE4 sum = WIDE4(0);
#ifdef SUNDER_SINGLE
  vec4 low = vec4(0);
  for (uint j = first; j < last; ++j) {
    const uvec4 entry = UVEC4(entries, j);
    const vec4 x = of_column(entry.x, pack);
    const vec2 c = uintBitsToFloat(entry.zw);  // high, low
    precise const vec4 product = x * c.x;
    precise const vec4 both = sum + product;
    precise const vec4 of_product = both - sum;
    precise const vec4 rest = (sum - (both - of_product)) + (product - of_product);
    low += rest + x * c.y;
    sum = both;
  }
  partial.data[2u * to] = sum;
  partial.data[2u * to + 1u] = low;
#else
  for (uint j = first; j < last; ++j) {
    const uvec4 entry = UVEC4(entries, j);
    sum += dvec4(of_column(entry.x, pack)) * packDouble2x32(entry.zw);
  }
  if (kLower != 0u && p.add != 0u) sum += partial.data[to];
  partial.data[to] = sum;
#endif
}
