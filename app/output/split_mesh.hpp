// SPDX-License-Identifier: Apache-2.0
// The body as split cracks leave it, and where their lips are drawn: faces of elements make a
// jagged crack, its ideal path is smooth (method.md "Split cracks").
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sunder/board_plane.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {

struct SplitMesh {
  Mesh mesh;                     ///< undeformed: the file's nodes, then those that have come
  std::vector<Index> in_file;    ///< per node: the file's node at its place
  std::vector<CrackFace> faces;  ///< open ones, by crack
  std::vector<Vec3> drawn;       ///< the nodes, those of `faces` moved onto the ideal paths
  std::vector<double> area;      ///< of each face, by face_areas() [mm^2]
};

/// Null while no crack has opened a face.
[[nodiscard]] std::shared_ptr<const SplitMesh> split_mesh(const Simulation& simulation);

/// The point of a polyline that is closest to p; its ends are prolonged.
[[nodiscard]] Vec2 closest_on_path(std::span<const Vec2> path, const Vec2& p);

/// Nodes with those of open faces moved, in the board's plane, onto the path of their crack. Those
/// on the board's outline stay on it. A node of two cracks lies on the path of the older one.
[[nodiscard]] std::vector<Vec3> on_ideal_paths(const Mesh& mesh, std::span<const CrackFace> faces,
                                               std::span<const Crack> cracks,
                                               const BoardPlane& plane);

/// Area of each open face's left lip on the ideal path; under 0 where a jagged crack folds back,
/// which others cover a second time.
[[nodiscard]] std::vector<double> face_areas(std::span<const Vec3> drawn,
                                             std::span<const CrackFace> faces,
                                             std::span<const Crack> cracks,
                                             const BoardPlane& plane);

/// How far the lips are apart at each node of `split` [mm]: the jump of the displacement across the
/// faces there, the largest of several; 0 where no face is open.
[[nodiscard]] std::vector<double> openings(const SplitMesh& split,
                                           std::span<const Vec3> displacement);

/// Area of the open faces of one crack or, kNone, of all: one lip's, as it is drawn, on the ideal
/// paths [mm^2].
[[nodiscard]] double crack_area(const SplitMesh& split, int crack = kNone);

}  // namespace sunder::app
