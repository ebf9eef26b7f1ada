// SPDX-License-Identifier: Apache-2.0
// How a split crack moves through the mesh (method.md "Split cracks"). Elements along its ideal
// path are labelled by the side of it on which they lie; faces between the two sides open, as far
// as the path goes and as far as they hang together with the front. Nothing comes loose by it:
// small groups of elements that only faces about to open would hold change sides instead.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "fracture/board.hpp"
#include "fracture/face.hpp"
#include "fracture/split/split_body.hpp"
#include "sunder/crack.hpp"

namespace sunder::fracture {

/// What a split crack is in the mesh, beside the record of its ideal path.
struct SplitCrack {
  std::map<Index, std::int8_t> label;       ///< of elements at its faces: +1 left of the path
  std::array<std::vector<Index>, 2> front;  ///< nodes where each tip's faces end
  std::vector<Face> faces;  ///< opened by it, as the element left of the path has them
  double area = 0;          ///< of them [mm^2]
  bool grown = false;       ///< its tips are at fronts of its own
};

/// What has moved, and what the body must follow.
struct SplitStep {
  fem::Change change;
  double advance = 0;    ///< of the front along its heading [mm]
  double area = 0;       ///< opened [mm^2]
  bool through = false;  ///< no front is left: run out, or met another crack
  bool held = false;     ///< tissue ahead that does not part; the path is as it was
  bool spent = false;    ///< more nodes would have come than the body allows
  [[nodiscard]] bool moved() const { return !change.come.empty(); }
};

class SplitFront {
 public:
  /// All must outlive it.
  SplitFront(const Board& board, const Problem& problem, SplitBody& body);

  /// Whether the tissue between two elements parts.
  using Parts = std::function<bool(Index, Index)>;

  /// Nodes of the mesh's own tip there, or of destroyed elements that end there.
  [[nodiscard]] std::vector<Index> nodes_at(const Vec2& tip) const;
  /// Moves a tip by about `length` along a unit direction: the path by as many such pieces, at most
  /// six, as the front needs to move.
  [[nodiscard]] SplitStep advance(Crack& crack, SplitCrack& split, std::size_t tip,
                                  const Vec2& direction, double length,
                                  std::span<const std::uint8_t> destroyed, const Parts& parts);
  /// Opens faces along the path of a crack that an element bears, at both ends, through the
  /// thickness; lengthens the path until some do.
  [[nodiscard]] SplitStep bear(Crack& crack, SplitCrack& split, Index element,
                               std::span<const std::uint8_t> destroyed, const Parts& parts);
  /// Makes a crack with a path (path_through()) of a sheet whose faces have just been opened: a tip
  /// at each end of it that lies inside the body, on the mesh's front there.
  void take_cut(Crack& crack, SplitCrack& split, std::span<const PassedFace> sheet,
                std::span<const std::uint8_t> destroyed) const;

 private:
  struct Work;
  [[nodiscard]] int side_of(const Crack& crack, Index element) const;
  void label_band(Work& work) const;
  [[nodiscard]] bool within(const Face& face, const Work& work) const;
  void find_faces(Work& work) const;
  void join(Work& work) const;
  [[nodiscard]] bool turn_small_groups(Work& work, bool keep) const;
  [[nodiscard]] bool open_along(Work& work);
  [[nodiscard]] std::vector<Index> front_of(const Crack& crack, const SplitCrack& split,
                                            std::size_t tip,
                                            std::span<const std::uint8_t> destroyed) const;
  [[nodiscard]] std::vector<Index> front_within(double radius, const Crack& crack,
                                                const SplitCrack& split, std::size_t tip,
                                                std::span<const std::uint8_t> destroyed) const;
  [[nodiscard]] bool through_thickness(const fem::Change& change) const;
  [[nodiscard]] bool outside(const Vec2& p) const;
  [[nodiscard]] double area_of(const Face& face) const;
  [[nodiscard]] Vec2 middle(std::span<const Index> nodes) const;

  const Board& board_;
  const Problem& problem_;
  SplitBody& body_;
};

}  // namespace sunder::fracture
