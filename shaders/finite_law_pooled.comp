#version 460
// SPDX-License-Identifier: Apache-2.0
// Laws of a body of which some elements share their volume in patches (finite_pools.comp).
#extension GL_GOOGLE_include_directive : require
#define SUNDER_POOLED
#include "finite_law.glsl"
