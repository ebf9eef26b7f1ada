// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"

layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 corner;
layout(location = 3) flat in vec3 colour;
layout(location = 4) flat in uint flags;
layout(location = 0) out vec4 shown;

// A face that looks at the eye has its colour as the scale has it.
const float kAmbient = 0.34, kFromEye = 0.66, kFromKey = 0.3;
const float kOpenShade = 0.8, kInsideShade = 0.5;  // of what a tear lays open; of what a clip shows
const vec3 kEdge = vec3(0.10, 0.11, 0.13);

void main() {
  const vec3 across = fwidth(corner);
  if (push.plane.xyz != vec3(0) && dot(push.plane.xyz, place) > push.plane.w) discard;
  vec3 n = normalize(normal);
  float shade = gl_FrontFacing ? 1 : kInsideShade;
  if (!gl_FrontFacing) n = -n;
  if ((flags & kOpened) != 0) shade *= kOpenShade;
  const float lit = kAmbient + kFromEye * max(dot(n, push.eye.xyz), 0) +
                    kFromKey * max(dot(n, push.key.xyz), 0);
  vec3 c = colour * min(lit, 1) * shade;
  if (push.key.w > 0) {
    const vec3 pixels = corner / max(across, vec3(1e-6));
    const float nearest = min(pixels.x, min(pixels.y, pixels.z));
    c = mix(kEdge, c, smoothstep(0.4, 1.2, nearest));
  }
  shown = vec4(c, 1);
}
