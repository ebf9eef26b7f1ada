// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "view.glsl"

layout(location = 0) in vec3 place;
layout(location = 0) out vec4 shown;

void main() {
  if (push.plane.xyz != vec3(0) && dot(push.plane.xyz, place) > push.plane.w) discard;
  shown = vec4(0.10, 0.11, 0.13, 1);
}
