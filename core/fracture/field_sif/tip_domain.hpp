// SPDX-License-Identifier: Apache-2.0
// The ring of elements around a crack tip over which the interaction integral runs, with the
// weight q: 1 within half the radius, 0 beyond the radius, linear between.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/field_sif/free_surface.hpp"

namespace sunder::fracture {

/// Axes at a tip: x1 along its direction, x2 to its left, x3 the board's normal.
struct TipFrame {
  Vec2 position, direction;

  [[nodiscard]] Vec2 local(const Vec2& p) const {
    const Vec2 x = p - position;
    return {x.dot(direction), direction.x() * x.y() - direction.y() * x.x()};
  }
  /// Rows: the axes in space. The board's own axes may be left-handed; nothing here minds.
  [[nodiscard]] Mat3 axes(const BoardPlane& plane) const;
};

/// A stretch of the front: its weight falls linearly from 1 at `at` to 0 at at +- width, mm along
/// the board's normal.
struct FrontStretch {
  double at = 0, width = 0;
};

/// Elements whose weight varies or that carry a part of the body's surface, and their nodes in
/// order of first use. Only these nodes' displacements enter.
struct TipDomain {
  double radius = 0;        ///< [mm]
  double front_length = 0;  ///< integral of q along the front [mm]
  std::vector<Index> elements;
  std::vector<std::array<Index, 4>> corners;  ///< per element: places in `nodes`
  std::vector<Index> nodes;                   ///< of the body as it is, new ones too
  std::vector<Index> in_mesh;                 ///< where those lie: nodes of the mesh
  std::vector<double> weight;                 ///< q per node
};

/// q at a distance r from the front.
[[nodiscard]] double domain_weight(double r, double radius);

/// Collects domains; keeps scratch of the mesh's size so that a domain costs what lies in it.
class DomainBuilder {
 public:
  DomainBuilder(const Board& board, const FreeSurface& surface)
      : board_(board), surface_(surface), place_(board.mesh().nodes.size()) {}

  /// Room for the fullest domain of that radius.
  void reserve(double radius, TipDomain& domain);
  /// `corners`: of all elements where some are split from others; empty: as the mesh has them.
  /// Live elements of the ring, by id, and within it those on the named part of the surface; over
  /// the whole thickness, or around a stretch of the front. In place of what `domain` held.
  void collect(const Vec2& tip, double radius, std::span<const std::uint8_t> destroyed,
               FreeSurface::Part part, const std::optional<FrontStretch>& stretch,
               std::span<const std::array<Index, 4>> corners, TipDomain& domain);

 private:
  struct Place {
    std::uint32_t round = 0;  // of the domain that saw the node last
    Index at = kNone;         // in its nodes
    double weight = 0;
  };
  Place& place_of(Index node, Index in_mesh, const Vec2& tip, double radius,
                  const std::optional<FrontStretch>& stretch);

  const Board& board_;
  const FreeSurface& surface_;
  std::vector<Place> place_;  // shape (nodes), as many as have been seen
  std::uint32_t round_ = 0;
  std::vector<Index> near_;  // elements around the tip in work
};

}  // namespace sunder::fracture
