// SPDX-License-Identifier: Apache-2.0
// Shared by the kernels of bodies at finite deformation: fp64 throughout.
#include "common.glsl"
#include "reduce.glsl"
#include "part_sum.glsl"

double infinity() { return packDouble2x32(uvec2(0u, 0x7ff00000u)); }
// NaN included.
double bounded(double x) { return x < infinity() ? x : infinity(); }
