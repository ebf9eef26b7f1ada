// SPDX-License-Identifier: Apache-2.0
// A symmetric matrix whose tiles over the diagonal are out of date: the low-rank update leaves them,
// which halves its traffic. Columns are then read as columns from the diagonal's tile on and as
// rows before it. Wants `matrix`, a panel, and `p` with packs, first_column and columns.
layout(constant_id = 2) const uint kLower = 0u;  // 1: so it is; 0: the matrix is whole

// Rows 4 pack to 4 pack + 3 of a column, as far as this panel has them; else zero.
REAL4 of_lower(uint column, uint pack) {
  const bool direct = 4u * pack / kTile >= column / kTile;
  const uint within = (direct ? column : 4u * pack) - p.first_column;
  const bool here = within < p.columns;
#ifdef SUNDER_LVP  // nothing branches there
  const uint at = here ? within * p.packs + (direct ? pack : column / 4u) : 0u;
  const uint step = here && !direct ? p.packs : 0u;
  const REAL4 a = LOAD_REAL4(matrix, at), b = LOAD_REAL4(matrix, at + step),
              c = LOAD_REAL4(matrix, at + 2u * step), d = LOAD_REAL4(matrix, at + 3u * step);
  const uint q = column % 4u;
  const REAL4 across = REAL4(a[q], b[q], c[q], d[q]);
  return here ? (direct ? a : across) : REAL4(0);
#else
  if (!here) return REAL4(0);
  if (direct) return LOAD_REAL4(matrix, within * p.packs + pack);
  const uint at = within * p.packs + column / 4u, q = column % 4u;
  return REAL4(LOAD_REAL4(matrix, at)[q], LOAD_REAL4(matrix, at + p.packs)[q],
               LOAD_REAL4(matrix, at + 2u * p.packs)[q], LOAD_REAL4(matrix, at + 3u * p.packs)[q]);
#endif
}

REAL4 of_column(uint column, uint pack) {
  if (kLower != 0u) return of_lower(column, pack);
  return LOAD_REAL4(matrix, (column - p.first_column) * p.packs + pack);
}
