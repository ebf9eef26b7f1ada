// SPDX-License-Identifier: Apache-2.0
// q = K p (stiffness_rows.glsl). Partial sums of p^T q. SUNDER_POOLED: patches of pooled volume add
// their forces.
#include "cg.glsl"

IN_UVEC4(2, Dofs, dofs)
IN_DVEC4(3, P, direction)
OUT(4, Q, dvec4, q)
OUT(5, Partial, double, partial)
#define SUNDER_ROWS_BINDING 0
#define SUNDER_ROWS_OF(j) DVEC4(direction, j).xyz
#include "stiffness_rows.glsl"
#ifdef SUNDER_POOLED
#define SUNDER_PATCH_BINDING 6
#include "patch_forces.glsl"
#endif

void main() {
  const uint n = invocation(), slice = workgroup();
  const dvec3 own = DVEC4(direction, n).xyz;
  dvec3 sum = stiffness_row(slice, own);
#ifdef SUNDER_POOLED
  sum += force_of_patches(slice);
#endif
  sum = mix(sum, dvec3(0), held_axes(UVEC4(dofs, n)));
  STORE_THREE(q.data[n], sum);
  const double pq = part_sum(dot(sum, own));
  if (leads_part()) partial.data[part()] = pq;
}
