#version 460
// SPDX-License-Identifier: Apache-2.0
// The body from the host's rest positions and the solver's three buffers: twelve vertices a
// tetrahedron, four faces. Destroyed elements give no triangle.
layout(std430, set = 0, binding = 0) readonly buffer Rest { vec4 rest[]; };
layout(std430, set = 0, binding = 1) readonly buffer Tets { uvec4 tets[]; };
layout(std430, set = 0, binding = 2) readonly buffer Displacement { vec4 displacement[]; };
layout(std430, set = 0, binding = 3) readonly buffer Stress { vec2 stress[]; };
layout(std430, set = 0, binding = 4) readonly buffer Live { uint live[]; };
layout(push_constant) uniform Push { mat4 view; };
layout(location = 0) out vec3 colour;
layout(location = 1) out vec3 corner;  // barycentric, for the edges

const uint kFaces[12] = uint[](0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3);

vec3 place(uint node) { return rest[node].xyz + displacement[node].xyz; }

void main() {
  const uint element = gl_VertexIndex / 12, face = gl_VertexIndex % 12 / 3 * 3, k = gl_VertexIndex % 3;
  const vec3 a = place(tets[element][kFaces[face]]), b = place(tets[element][kFaces[face + 1]]),
             c = place(tets[element][kFaces[face + 2]]);
  const vec3 normal = normalize((view * vec4(cross(b - a, c - a), 0)).xyz);
  const bool frame = stress[element].y == 0.0;  // unbreakable
  const vec3 tissue = mix(vec3(0.98, 0.86, 0.78), vec3(0.85, 0.02, 0.02), min(stress[element].y, 1.0));
  colour = (frame ? vec3(0.55) : tissue) * (0.75 + 0.25 * abs(normal.z));
  corner = vec3(k == 0, k == 1, k == 2);
  gl_Position = view * vec4(k == 0 ? a : k == 1 ? b : c, 1);
  if (live[element] == 0u) gl_Position = vec4(2, 2, 2, 1);  // all three alike, outside: no triangle
}
