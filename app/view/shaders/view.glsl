// SPDX-License-Identifier: Apache-2.0
// What the renderer's shaders share: its buffers and what is pushed with each picture.

layout(std430, binding = 0) readonly buffer Places { vec4 places[]; };    // of nodes [mm]
layout(std430, binding = 1) readonly buffer Normals { vec4 normals[]; };  // outward; 0: none
layout(std430, binding = 2) readonly buffer Triangles { uvec4 triangles[]; };  // nodes, flags
layout(std430, binding = 3) readonly buffer Values { float values[]; };  // of triangles, one or several
layout(std430, binding = 4) readonly buffer Lips { uvec2 lips[]; };       // nodes
// Evenly from 0 to 1, then that of what is grey, then that of what nothing is known of; 8 bits a channel.
layout(std430, binding = 5) readonly buffer Shades { uint shades[]; };

layout(push_constant) uniform Push {
  mat4 to_clip;
  vec4 key;    // towards the light; w: 1 with wireframe
  vec4 eye;    // towards the eye
  vec4 plane;  // what lies beyond is left out: dot(plane.xyz, place) > plane.w; 0: nothing
  vec2 half_width;  // of a lip's edge, in clip space
  uint value_of;    // of a triangle: how many numbers it has, and from bit kItemBits on which one is meant
  float per_value;  // 1 / the end of the scale; under 0: nothing is known
} push;

const uint kOpened = 1u;  // of a triangle: a tear has laid it open
const uint kGrey = 2u;    // it has no colour of the scale
const uint kItemBits = 4u;
