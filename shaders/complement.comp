#version 460
// SPDX-License-Identifier: Apache-2.0
// X = S (I - B) S for a diagonal S, rounded to storage precision: the last step of the inversion on the
// device; `mirror`: X = S B S. Of B only the lower tiles count, X is whole; a dispatch fills in what one
// panel of B has. In place by two dispatches: the tiles over the diagonal from those under it, then these themselves.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

IN_DVEC4(0, Swept, swept)
IN_DVEC4(1, Scales, scales)  // the diagonal of S; zero of padding
OUT(2, Matrix, REAL4, matrix)
layout(push_constant) uniform Push { ComplementPush p; };

void main() {
  const uint pack = invocation(), column = p.to + gl_WorkGroupID.y;
  const bool direct = 4u * pack / kTile >= column / kTile;
  const uint within = (direct ? column : 4u * pack) - p.first_column;
  if (within < p.columns && p.left_out != (direct ? kLowerTiles : kUpperTiles)) {
    const uint at = within * p.packs + (direct ? pack : column / 4u);
    const uint step = direct ? 0u : p.packs, q = column % 4u;
    dvec4 value = -DVEC4(swept, at);
    if (!direct) {
      value = -dvec4(DVEC4(swept, at)[q], DVEC4(swept, at + step)[q], DVEC4(swept, at + 2u * step)[q],
                     DVEC4(swept, at + 3u * step)[q]);
    }
    if (p.mirror != 0u) value = -value;
    const double one = p.mirror != 0u ? 0.0LF : 1.0LF;
    [[unroll]] for (uint i = 0u; i < 4u; ++i) value[i] += 4u * pack + i == column ? one : 0.0LF;
    const double scale = DVEC4(scales, column / 4u)[q];
    const dvec4 result = scale > 0.0LF ? scale * DVEC4(scales, pack) * value : dvec4(0);
    matrix.data[gl_WorkGroupID.y * p.packs + pack] = REAL4(result);
  }
}
