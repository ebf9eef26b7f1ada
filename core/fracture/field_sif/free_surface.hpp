// SPDX-License-Identifier: Apache-2.0
// Free faces of the intact body, by element: where a domain is cut off by the body's surface.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fracture/board.hpp"

namespace sunder::fracture {

class FreeSurface {
 public:
  struct Face {
    std::array<Index, 3> nodes;
    Vec3 area;          ///< outward normal times area [mm^2]
    bool lateral;       ///< of the outline or a hole, not of the top or bottom surface
    int notch = kNone;  ///< crack whose face it is
  };

  enum class Part { outline, all };

  explicit FreeSurface(const Board& board);
  [[nodiscard]] std::span<const Face> of(Index element) const {
    return {faces_.data() + begin_[element], begin_[element + 1] - begin_[element]};
  }
  [[nodiscard]] std::span<const Face> all() const { return faces_; }
  /// From now on a face of this crack, not of the outline.
  void mark(std::size_t face, int crack) { faces_[face].notch = crack; }
  [[nodiscard]] bool touches(Index element, Part part) const;

 private:
  std::vector<Face> faces_;         // by element
  std::vector<std::size_t> begin_;  // shape (elements + 1)
};

}  // namespace sunder::fracture
