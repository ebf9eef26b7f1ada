// SPDX-License-Identifier: Apache-2.0
// An edge of a lip as a strip of even width on the picture, a little nearer to the eye.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"

layout(location = 0) out vec3 place;

const float kNearer = 2e-4;

void main() {
  const uvec2 edge = lips[gl_VertexIndex / 6];
  const uint i = gl_VertexIndex % 6;  // two triangles: 0 1 2, 2 1 3
  const uint c = i < 3 ? i : i == 3 ? 2 : i == 4 ? 1 : 3;
  const vec3 at = places[(c & 1) == 0 ? edge.x : edge.y].xyz;
  const vec4 a = push.to_clip * vec4(places[edge.x].xyz, 1);
  const vec4 b = push.to_clip * vec4(places[edge.y].xyz, 1);
  const vec2 along = (b.xy - a.xy) / push.half_width;  // in half widths, the same on both axes
  const float size = length(along);
  const vec2 d = size > 0 ? along / size : vec2(1, 0);
  place = at;
  gl_Position = push.to_clip * vec4(at, 1);
  gl_Position.xy += vec2(-d.y, d.x) * push.half_width * ((c & 2) == 0 ? 1 : -1);
  gl_Position.z -= kNearer;
}
