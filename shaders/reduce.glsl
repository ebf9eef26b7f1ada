// SPDX-License-Identifier: Apache-2.0
// Reductions in a fixed order: subgroup first. `lvp` leaves one result for every subgroup to the
// summary, for a barrier on lavapipe makes every subgroup a coroutine; `gpu` folds the subgroups'
// results in shared memory and leaves one for every workgroup, whatever a subgroup's size: drivers choose
// it kernel by kernel. Only `lvp` counts on kSubgroup, which it asks for (gpu/vulkan/kernel.cpp).
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

#ifdef SUNDER_LVP
layout(constant_id = 1) const uint kSubgroup = 8u;  // invocations of a subgroup
const uint kParts = kGroup / kSubgroup;
// Where this invocation's group of invocations leaves its result, and which of them does so.
uint part() { return workgroup() * kParts + gl_SubgroupID; }
bool leads_part() { return subgroupElect(); }
#else
const uint kParts = 1u;
uint part() { return workgroup(); }
bool leads_part() { return gl_LocalInvocationID.x == 0u; }
#endif

// Largest value and the lowest element that has it; value 0: none (kHeld).
struct Worst {
  REAL ratio;
  uint element;
};

void keep_worse(inout Worst a, Worst b) {
  if (b.ratio > a.ratio || (b.ratio == a.ratio && b.element < a.element)) a = b;
}

Worst subgroup_worst(Worst w) {
  const REAL ratio = subgroupMax(w.ratio);
  return Worst(ratio, subgroupMin(w.ratio == ratio ? w.element : kHeld));
}
