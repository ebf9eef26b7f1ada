#version 460
// SPDX-License-Identifier: Apache-2.0
// Stress of a body of which some elements share their volume in patches (pools.comp).
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_gpu_shader_int64 : enable
#define SUNDER_POOLED
#include "stress.glsl"
