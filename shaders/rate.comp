#version 460
// SPDX-License-Identifier: Apache-2.0
// What a device does in a second (gpu/device_rates): each invocation reads packs of values and sums
// them, then multiplies and adds.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_WIDE4(0, Source, source)
OUT(1, Result, WIDE, result)
layout(push_constant) uniform Push { RatePush p; };

void main() {
  const uint i = invocation();
  WIDE4 sum = WIDE4(0);
  for (uint r = 0u; r < p.reads; ++r) {
    const uint at = i + r * p.invocations;
#ifdef SUNDER_SINGLE
    sum += VEC4(source, at);
#else
    sum += DVEC4(source, at);
#endif
  }
  WIDE4 value = sum;
  for (uint t = 0u; t < p.turns; ++t) {
    [[unroll]] for (uint k = 0u; k < kRateUnrolled; ++k) value = value * sum + sum;
  }
  result.data[i] = value.x + value.y + value.z + value.w;
}
