// SPDX-License-Identifier: Apache-2.0
// Sums and largest values over what leaves one result together (reduce.glsl), in a fixed order. `lvp`:
// kernels of one workgroup, or of one for each result, have workgroups of one subgroup.
#ifndef SUNDER_LVP
shared double subgroup_sums[kClosingGroup];  // subgroups may be of one invocation
#endif

double part_sum(double value) {
  value = subgroupAdd(value);
#ifndef SUNDER_LVP
  barrier();
  if (subgroupElect()) subgroup_sums[gl_SubgroupID] = value;
  barrier();
  value = subgroup_sums[0];
  for (uint s = 1u; s < gl_NumSubgroups; ++s) value += subgroup_sums[s];
#endif
  return value;
}

double part_max(double value) {
  value = subgroupMax(value);
#ifndef SUNDER_LVP
  barrier();
  if (subgroupElect()) subgroup_sums[gl_SubgroupID] = value;
  barrier();
  value = subgroup_sums[0];
  for (uint s = 1u; s < gl_NumSubgroups; ++s) value = max(value, subgroup_sums[s]);
#endif
  return value;
}
