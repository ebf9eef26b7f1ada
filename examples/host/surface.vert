#version 460
// SPDX-License-Identifier: Apache-2.0
// The body from its surface as the solver keeps it in the host's own buffers: three vertices a triangle of
// live tissue. The same colours as body.vert has.
layout(std430, set = 0, binding = 3) readonly buffer Stress { vec2 stress[]; };
layout(std430, set = 0, binding = 5) readonly buffer Vertices { vec4 vertices[]; };  // place, normal
layout(std430, set = 0, binding = 6) readonly buffer Triangles { uint triangles[]; };
layout(std430, set = 0, binding = 7) readonly buffer Facts { int facts[]; };  // element, piece, opened
layout(push_constant) uniform Push { mat4 view; };
layout(location = 0) out vec3 colour;
layout(location = 1) out vec3 corner;

void main() {
  const uint k = gl_VertexIndex % 3;
  const int element = facts[gl_VertexIndex / 3 * 3];
  const uint node = triangles[gl_VertexIndex];
  const vec3 normal = (view * vec4(vertices[2 * node + 1].xyz, 0)).xyz;
  const float up = abs(normal.z) / max(length(normal), 1e-12);
  const vec3 tissue = mix(vec3(0.98, 0.86, 0.78), vec3(0.85, 0.02, 0.02), min(stress[element].y, 1.0));
  colour = (stress[element].y == 0.0 ? vec3(0.55) : tissue) * (0.75 + 0.25 * up);
  corner = vec3(k == 0, k == 1, k == 2);
  gl_Position = view * vec4(vertices[2 * node].xyz, 1);
}
