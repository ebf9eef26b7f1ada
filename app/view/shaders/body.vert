// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"

layout(location = 0) out vec3 place;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 corner;  // barycentric
layout(location = 3) flat out uint colour;
layout(location = 4) flat out uint flags;

const float kCrease = 0.85;  // cosine, between a face and its node's normal: beyond, it is an edge

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
  colour = colours[t];
  flags = triangle.w;
  gl_Position = push.to_clip * vec4(place, 1);
}
