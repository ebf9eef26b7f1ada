// SPDX-License-Identifier: Apache-2.0
// Which elements a growing tip destroys and how far it moves (method.md 10): the band of elements
// that the ray ahead of the tip separates, walked in order of distance.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/toughness.hpp"
#include "sunder/crack.hpp"

namespace sunder::fracture {

/// What a walk needs to know of elements, so that it depends on neither problem nor backend.
struct ElementView {
  std::span<const std::uint8_t> destroyed;   ///< per element
  std::span<const double> yield;             ///< [MPa] per element; 0: none
  std::span<const std::uint8_t> taken = {};  ///< by this event already; empty: none
  bool breakable_only = false;               ///< those without yield count as not there
  ToughnessView toughness = {};              ///< at the tip

  [[nodiscard]] bool live(Index e) const {
    return !destroyed[e] && (taken.empty() || !taken[e]) && (!breakable_only || yield[e] > 0);
  }
};

/// The ray ahead of a tip, and the side labels that its crack has given to nodes.
struct Ray {
  Vec2 origin;     ///< p, the tip
  Vec2 direction;  ///< g, unit
  const Crack* crack = nullptr;
  int orientation = 1;  ///< of the tip (crack_path.hpp): labels are left/right of the path
};

struct BandElement {
  Index element;
  double rho;  ///< distance of its centroid along the ray from p [mm]
};

/// Live elements separated by the ray, -h/2 < rho <= 1.5 h, in order of rho (ties: lowest id),
/// and on which side nodes within 0.2 h of the ray were put: +1 left, -1 right.
struct Band {
  std::vector<BandElement> elements;
  int near_side = 1;
  double size = 0;  ///< local h: mean projected edge length of its elements [mm]
};

/// Searches of one board, with lists that have room for the fullest of its places.
class BandSearch {
 public:
  explicit BandSearch(const Board& board);
  /// Holds until the next search.
  [[nodiscard]] const Band& find(const Ray& ray, const ElementView& view);
  /// No band has more elements.
  [[nodiscard]] std::size_t most() const { return near_.capacity(); }

 private:
  const Board& board_;
  double reach_;  // [mm] from the middle of a band to the farthest centroid
  std::vector<Index> near_;
  std::array<std::vector<BandElement>, 2> bands_;  // one for each choice of near_side: -1, +1
  Band band_;
};

/// Side of a node as seen by the tip: +1 left of the ray, -1 right of it; 0 for a node behind the
/// tip on the prolonged ray.
[[nodiscard]] int node_side(const Board& board, const Ray& ray, int near_side, Index node);

struct Passed {
  Index element;
  double rho;            ///< [mm]
  double reach;          ///< r_e [mm] (Eq. 1); 0 where the material's toughness decides
  double ratio;          ///< r_e / max(rho, h/2), K / K_c by toughness
  double toughness = 0;  ///< K_c [MPa sqrt(mm)]; 0: none
};

struct Walk {
  std::vector<Passed> passed;  ///< elements to destroy, in order
  double advance = 0;          ///< of the tip [mm]; 0 when nothing is destroyed
};

/// Walks the band with stress intensity K and angle theta [rad], in place of what `walk` held. By
/// toughness where an element has one (method.md "Toughness"), else by Eq. 1.
void walk_band(const Band& band, double h, double k, double theta, const ElementView& view,
               Walk& walk);

}  // namespace sunder::fracture
