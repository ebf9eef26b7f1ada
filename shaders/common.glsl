// SPDX-License-Identifier: Apache-2.0
// How a kernel reads its inputs. Two variants from one source: `gpu` reads storage buffers; `lvp`
// reads texel buffers, which lavapipe turns into vector gathers where it would run a storage read
// as a loop over lanes (measured on Mesa 22.3.6: 2.8 to 5.5 times faster).
#extension GL_EXT_control_flow_attributes : require

// What sums, ratios and displacements are kept in. SUNDER_SINGLE: a device without shaderFloat64, where
// displacements are two floats each (two_float.glsl) and the host does what needs more.
#ifdef SUNDER_SINGLE
#define WIDE float
#define WIDE4 vec4
#define NODAL vec2
#define IN_WIDE4 IN_VEC4
#else
#define WIDE double
#define WIDE4 dvec4
#define NODAL double
#define IN_WIDE4 IN_DVEC4
#endif
#include "layout.h"

#ifdef SUNDER_LVP
#define IN_VEC4(b, Block, name) layout(set = 0, binding = b) uniform samplerBuffer name;
#define IN_DVEC4(b, Block, name) layout(set = 0, binding = b) uniform usamplerBuffer name;
#define IN_UVEC4(b, Block, name) layout(set = 0, binding = b) uniform usamplerBuffer name;
#define VEC4(name, i) texelFetch(name, int(i))
#define UVEC4(name, i) texelFetch(name, int(i))
dvec4 fetch_dvec4(usamplerBuffer buffer_, uint i) {
  const uvec4 a = texelFetch(buffer_, int(2u * i));
  const uvec4 b = texelFetch(buffer_, int(2u * i + 1u));
  return dvec4(packDouble2x32(a.xy), packDouble2x32(a.zw), packDouble2x32(b.xy),
               packDouble2x32(b.zw));
}
#define DVEC4(name, i) fetch_dvec4(name, i)
#else
#define IN_VEC4(b, Block, name) \
  layout(std430, set = 0, binding = b) readonly buffer Block { vec4 data[]; } name;
#define IN_DVEC4(b, Block, name) \
  layout(std430, set = 0, binding = b) readonly buffer Block { dvec4 data[]; } name;
#define IN_UVEC4(b, Block, name) \
  layout(std430, set = 0, binding = b) readonly buffer Block { uvec4 data[]; } name;
#define VEC4(name, i) name.data[i]
#define DVEC4(name, i) name.data[i]
#define UVEC4(name, i) name.data[i]
#endif

#ifndef SUNDER_SINGLE
// A number among values in fp64, as bits of one near 1: lavapipe takes longer to convert one than to load it.
uint number_in(double bits) { return unpackDouble2x32(bits).x; }
#endif
// Three values of a pack of four whose fourth is 0 from the first: lavapipe stores them one by one.
#ifdef SUNDER_LVP
#define STORE_THREE(place, value) place.xyz = value
#else
#define STORE_THREE(place, value) place = dvec4(value, 0)
#endif

// Storage precision of the inverse and of element stress.
#ifdef SUNDER_FP64
#define REAL double
#define REAL3 dvec3
#define REAL4 dvec4
#define IN_REAL4 IN_DVEC4
#define LOAD_REAL4 DVEC4
#else
#define REAL float
#define REAL3 vec3
#define REAL4 vec4
#define IN_REAL4 IN_VEC4
#define LOAD_REAL4 VEC4
#endif

// Written or read one by one.
#define IN_WORDS(b, Block, name) \
  layout(std430, set = 0, binding = b) readonly buffer Block { uint data[]; } name;
#define IN_DOUBLES(b, Block, name) \
  layout(std430, set = 0, binding = b) readonly buffer Block { double data[]; } name;
#define OUT(b, Block, type, name) \
  layout(std430, set = 0, binding = b) writeonly buffer Block { type data[]; } name;
#define INOUT(b, Block, type, name) \
  layout(std430, set = 0, binding = b) buffer Block { type data[]; } name;

layout(local_size_x_id = 0, local_size_y = 1, local_size_z = 1) in;

// A dispatch of more workgroups along x than a device takes is folded along z, in rows of so many
// (gpu/vulkan/folded_groups.hpp).
layout(constant_id = 3) const uint kRowOfGroups = 65535u;
uint workgroup() { return gl_WorkGroupID.x + gl_WorkGroupID.z * kRowOfGroups; }
uint invocation() { return workgroup() * gl_WorkGroupSize.x + gl_LocalInvocationID.x; }
