#version 460
// SPDX-License-Identifier: Apache-2.0
// An arrow that hangs on a node of the deformed body, in front of everything.
layout(std430, set = 0, binding = 0) readonly buffer Rest { vec4 rest[]; };
layout(std430, set = 0, binding = 2) readonly buffer Displacement { vec4 displacement[]; };
layout(push_constant) uniform Push {
  mat4 view;
  vec4 along;  // direction and length [mm]
  uint node;
};
layout(location = 0) out vec3 colour;
layout(location = 1) out vec3 corner;

const vec2 kArrow[9] = vec2[](vec2(0, -.06), vec2(.7, -.06), vec2(.7, .06), vec2(0, -.06),
                              vec2(.7, .06), vec2(0, .06), vec2(.7, -.18), vec2(1, 0), vec2(.7, .18));

void main() {
  const vec2 p = kArrow[gl_VertexIndex];
  const vec3 side = vec3(-along.y, along.x, 0);
  const vec3 x = rest[node].xyz + displacement[node].xyz + p.x * along.xyz + p.y * side;
  gl_Position = view * vec4(x, 1);
  gl_Position.z = 0.0;
  colour = vec3(1.0, 0.8, 0.0);
  corner = vec3(1);  // no edges
}
