// SPDX-License-Identifier: Apache-2.0
// What is odd in a mesh that is valid: elements twice, cuts that duplicated nodes hide, parts on
// hinges. None of it is wrong by itself; each is said with its number and place.
#pragma once

#include <span>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder {

/// Elements with the same four corners as an earlier one.
struct DuplicateElements {
  Index count = 0;
  Index first = kNone, of = kNone;  ///< the first of them, and the one that it repeats
};
[[nodiscard]] DuplicateElements find_duplicates(const Mesh& mesh);

/// Two free faces in one place that share at most some of their nodes: the body is cut there.
/// Nodes have one place when they lie within a thousandth of the mesh's shortest edge.
struct HiddenCut {
  Index faces = 0;                       ///< pairs
  Index nodes = 0;                       ///< that repeat another one's place, of these faces
  Index element = kNone, other = kNone;  ///< of the first pair
  Vec3 place = Vec3::Zero();             ///< its centroid
};
/// What is joined by faces and hides no declared crack: a connected cut with a node beside one of
/// `declared` (mouth, tips), seen along `normal`, is that crack.
[[nodiscard]] HiddenCut find_hidden_cut(const Mesh& mesh, std::span<const Vec3> declared,
                                        const Vec3& normal);

/// Per element the part that shared faces join, numbered by first element.
struct FaceParts {
  std::vector<Index> part_of_element;
  Index count = 0;
};
[[nodiscard]] FaceParts find_face_parts(const Mesh& mesh);

}  // namespace sunder
