#version 460
// SPDX-License-Identifier: Apache-2.0
// q = K p of a body of which each element has its own volume.
#extension GL_GOOGLE_include_directive : require
#include "cg_multiply.glsl"
