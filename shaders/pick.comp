#version 460
// SPDX-License-Identifier: Apache-2.0
// block(r, c) = X(row_r, column_c), from the lower triangle, as far as this panel has it.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Matrix { REAL data[]; } matrix;
IN_WORDS(1, Dofs, dofs)  // rows, then columns
OUT(2, Block, double, block)
layout(push_constant) uniform Push { PickPush p; };

void main() {
  const uint r = invocation(), c = gl_GlobalInvocationID.y;
  if (r < p.rows) {
    const uint a = dofs.data[r], b = dofs.data[p.rows + c];
    const uint column = min(a, b) - p.first_column;
    if (column < p.panel_columns) {
      block.data[c * p.rows + r] = double(matrix.data[column * p.leading + max(a, b)]);
    }
  }
}
