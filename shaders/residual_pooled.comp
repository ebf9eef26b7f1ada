#version 460
// SPDX-License-Identifier: Apache-2.0
// r = f - K u of a body of which some elements share their volume in patches.
#extension GL_GOOGLE_include_directive : require
#define SUNDER_POOLED
#include "residual.glsl"
