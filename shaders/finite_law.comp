#version 460
// SPDX-License-Identifier: Apache-2.0
// Laws of elements whose volume is their own.
#extension GL_GOOGLE_include_directive : require
#include "finite_law.glsl"
