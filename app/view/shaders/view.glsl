// SPDX-License-Identifier: Apache-2.0
// What the renderer's shaders share: its buffers and what is pushed with each picture.

layout(std430, binding = 0) readonly buffer Places { vec4 places[]; };    // of nodes [mm]
layout(std430, binding = 1) readonly buffer Normals { vec4 normals[]; };  // outward; 0: none
layout(std430, binding = 2) readonly buffer Triangles { uvec4 triangles[]; };  // nodes, flags
layout(std430, binding = 3) readonly buffer Colours { uint colours[]; };  // of triangles, 8 bits each
layout(std430, binding = 4) readonly buffer Lips { uvec2 lips[]; };       // nodes

layout(push_constant) uniform Push {
  mat4 to_clip;
  vec4 key;    // towards the light; w: 1 with wireframe
  vec4 eye;    // towards the eye
  vec4 plane;  // what lies beyond is left out: dot(plane.xyz, place) > plane.w; 0: nothing
  vec2 half_width;  // of a lip's edge, in clip space
} push;

const uint kOpened = 1u;  // of a triangle: a tear has laid it open
