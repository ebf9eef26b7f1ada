#version 460
// SPDX-License-Identifier: Apache-2.0
// Preconditioner of conjugate gradients: the inverse of every node's 3 x 3 block of the tangent, inertia
// included. A block that is not positive definite is shifted by its own size.
#extension GL_GOOGLE_include_directive : require
#include "finite_cg.glsl"

IN_WORDS(2, First, first)    // of each node
IN_WORDS(3, Around, around)  // 4 * element + corner
IN_UVEC4(4, Dofs, dofs)
IN_DOUBLES(5, Target, target)  // as finite_gather
OUT(6, Inverses, dvec2, inverses)  // three a node: the upper triangle, row by row

void main() {
  const uint n = invocation();
  if (n >= p.nodes) return;
  const uint last = first.data[n + 1u];
  dmat3 block = dmat3(0.0LF);
  for (uint k = first.data[n]; k < last; ++k) {
    const uint e = around.data[k] / 4u;
    const dvec3 g = slope(e, around.data[k] % 4u);
    const Tangent of = load(e);
    [[unroll]] for (uint b = 0u; b < 9u; ++b) {
      [[unroll]] for (uint a = 0u; a <= b; ++a) {
        const double value = of.upper[b * (b + 1u) / 2u + a] * g[a / 3u] * g[b / 3u];
        block[b % 3u][a % 3u] += value;
        if (a != b) block[a % 3u][b % 3u] += value;
      }
    }
  }
  const uvec4 dof = UVEC4(dofs, n);
  const bvec3 held = held_axes(dof);
  [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) {
    if (dof[axis] != kHeld) block[axis][axis] += target.data[p.unknowns + dof[axis]];
    [[unroll]] for (uint other = 0u; other < 3u; ++other) {
      if (held[axis] || held[other]) block[axis][other] = axis == other ? 1.0LF : 0.0LF;
    }
  }
  const double size = sqrt(dot(block[0], block[0]) + dot(block[1], block[1]) + dot(block[2], block[2]));
  const double two = block[0][0] * block[1][1] - block[0][1] * block[1][0];
  if (!(block[0][0] > 0.0LF && two > 0.0LF && determinant(block) > 1e-12LF * size * size * size)) {
    [[unroll]] for (uint axis = 0u; axis < 3u; ++axis) block[axis][axis] += size > 0.0LF ? size : 1.0LF;
  }
  const dmat3 c = dmat3(cross(block[1], block[2]), cross(block[2], block[0]), cross(block[0], block[1]));
  const dmat3 inverse_ = c * (1.0LF / dot(block[0], c[0]));
  const dvec3 free = mix(dvec3(1), dvec3(0), held);
  inverses.data[3u * n] = dvec2(inverse_[0][0] * free.x, inverse_[1][0] * free.x * free.y);
  inverses.data[3u * n + 1u] = dvec2(inverse_[2][0] * free.x * free.z, inverse_[1][1] * free.y);
  inverses.data[3u * n + 2u] = dvec2(inverse_[2][1] * free.y * free.z, inverse_[2][2] * free.z);
}
