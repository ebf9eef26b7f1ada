#version 460
// SPDX-License-Identifier: Apache-2.0
// Stress of elements whose volume is their own.
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_gpu_shader_int64 : enable
#include "stress.glsl"
