#version 460
// SPDX-License-Identifier: Apache-2.0
layout(location = 0) in vec3 colour;
layout(location = 1) in vec3 corner;
layout(location = 0) out vec4 pixel;

void main() {
  const float to_edge = min(corner.x, min(corner.y, corner.z));
  pixel = vec4(colour * (to_edge < 0.04 ? 0.7 : 1.0), 1);
}
