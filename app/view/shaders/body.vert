// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"

layout(location = 0) out vec3 place;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 corner;  // barycentric
layout(location = 3) flat out vec3 colour;
layout(location = 4) flat out uint flags;

const uint kLast = 8u;  // of the scale's shades
const float kCrease = 0.85;  // cosine, between a face and its node's normal: beyond, it is an edge

vec3 shade(uint i) { return unpackUnorm4x8(shades[i]).rgb; }

// In whole steps of eight bits, as the scale beside the picture has them.
vec3 colour_of(uint t, uint flags) {
  if (push.per_value < 0) return shade(kLast + 2u);
  if ((flags & kGrey) != 0) return shade(kLast + 1u);
  const uint item = push.value_of >> kItemBits, of_each = push.value_of & ((1u << kItemBits) - 1u);
  const float at = clamp(values[t * of_each + item] * push.per_value, 0, 1) * kLast;
  const uint low = min(uint(at), kLast - 1u);
  const vec3 mixed = mix(shade(low), shade(low + 1u), at - low);
  return floor(mixed * 255 + 0.5) / 255;
}

void main() {
  const uint t = gl_VertexIndex / 3, i = gl_VertexIndex % 3;
  const uvec4 triangle = triangles[t];
  const vec3 a = places[triangle.x].xyz, b = places[triangle.y].xyz, c = places[triangle.z].xyz;
  const uint node = i == 0 ? triangle.x : i == 1 ? triangle.y : triangle.z;
  place = i == 0 ? a : i == 1 ? b : c;
  const vec3 area = cross(b - a, c - a);
  const float size = length(area);
  const vec3 face = size > 0 ? area / size : push.eye.xyz;
  const vec3 smoothed = normals[node].xyz;
  normal = dot(smoothed, face) > kCrease ? smoothed : face;
  corner = vec3(i == 0, i == 1, i == 2);
  colour = colour_of(t, triangle.w);
  flags = triangle.w;
  gl_Position = push.to_clip * vec4(place, 1);
}
