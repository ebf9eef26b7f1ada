// SPDX-License-Identifier: Apache-2.0
#include "fracture/split/crack_tip_offset.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "fracture/crack_path.hpp"

namespace sunder::fracture {
namespace {

/// Offset in h by Poisson's ratio: K of edge cracks of split nodes, 10 to 18 elements long in
/// boards of 40 across and of one to three layers, against Tada's (split_test, SplitIntensity).
/// Beyond .49 elements lock and the last value is too small.
struct Row {
  double poisson, offset;
};
constexpr std::array<Row, 7> kTable{
    {{0, .46}, {.2, .42}, {.3, .41}, {.4, .43}, {.45, .51}, {.48, .70}, {.49, .92}}};
/// The same where volume is pooled, which does not lock: to .4999 the last value holds.
constexpr std::array<Row, 4> kPooled{{{0, .42}, {.3, .31}, {.45, .26}, {.49, .25}}};

}  // namespace

double tip_offset(const Board& board, const Material& tissue) {
  const std::span<const Row> rows =
      tissue.volume == MaterialVolume::pooled ? std::span<const Row>(kPooled) : kTable;
  const double nu = std::clamp(tissue.poisson, rows.front().poisson, rows.back().poisson);
  const auto above = std::ranges::find_if(rows, [&](const Row& row) { return row.poisson >= nu; });
  if (above == rows.begin()) return above->offset * board.h();
  const Row& below = *(above - 1);
  const double share = (nu - below.poisson) / (above->poisson - below.poisson);
  return (below.offset + share * (above->offset - below.offset)) * board.h();
}

Crack as_its_field_shows(const Crack& crack, std::size_t tip, const Board& board,
                         const Material& tissue) {
  Crack shorter = crack;
  CrackTip& at = shorter.tips[tip];
  auto& path = shorter.path;
  const bool backwards = orientation(crack, tip) < 0;
  if (backwards) std::reverse(path.begin(), path.end());
  const double along = (at.position - path.back()).dot(at.direction);
  at.position = path.back() + (along - tip_offset(board, tissue)) * at.direction;
  while (path.size() > 1 && (path.back() - at.position).dot(at.direction) >= 0) path.pop_back();
  path.push_back(at.position);
  if (backwards) std::reverse(path.begin(), path.end());
  return shorter;
}

}  // namespace sunder::fracture
