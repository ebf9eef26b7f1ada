// SPDX-License-Identifier: Apache-2.0
// Boards that a crack splits, and the same boards as meshes of their own, in which every node that
// came has unknowns of its own: what a fresh factor of them says is what the update must say.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "core/fracture/board_fixture.hpp"
#include "fracture/split/split_front.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {

/// A board of cubes whose inner nodes are moved at random, so that no edge follows a line.
inline Mesh shaken_board(const BoardShape& shape, std::mt19937& random, double by) {
  Mesh mesh = structured_board(shape);
  const Vec3 size(shape.width, shape.height, shape.depth);
  const Vec3 cells(shape.nx, shape.ny, shape.nz);
  std::uniform_real_distribution<double> part(-by, by);
  for (Vec3& x : mesh.nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool outside = x[axis] < 1e-9 || x[axis] > size[axis] - 1e-9;
      if (!outside) x[axis] += part(random) * size[axis] / cells[axis];
    }
  }
  return mesh;
}

/// A mesh and its image behind the plane x[axis] = at; element e + count of the image is the image
/// of element e, with its last two corners exchanged.
inline Mesh with_image(const Mesh& half, int axis, double at) {
  Mesh mesh = half;
  std::vector<Index> image;
  for (Index n = 0; n < half.node_count(); ++n) {
    Vec3 x = half.nodes[static_cast<std::size_t>(n)];
    if (std::abs(x[axis] - at) < 1e-12) {
      image.push_back(n);
      continue;
    }
    x[axis] = 2 * at - x[axis];
    image.push_back(static_cast<Index>(mesh.nodes.size()));
    mesh.nodes.push_back(x);
  }
  for (std::size_t e = 0; e < half.tets.size(); ++e) {
    auto tet = half.tets[e];
    for (Index& n : tet) n = image[static_cast<std::size_t>(n)];
    std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
    mesh.volume_of.push_back(half.volume_of[e]);
  }
  return mesh;
}

inline Vec2 turned_by(const Vec2& d, double angle) {
  return {std::cos(angle) * d.x() - std::sin(angle) * d.y(),
          std::sin(angle) * d.x() + std::cos(angle) * d.y()};
}

/// A crack that grows through a board: from the middle of the side x = 0 of one that begins at the
/// origin, or from elsewhere.
class EdgeSplit {
 public:
  explicit EdgeSplit(const Problem& problem)
      : problem_(problem),
        board(problem.mesh(), {}),
        body(problem),
        front(board, problem, body),
        destroyed(problem.mesh().tets.size(), 0) {}

  fracture::SplitStep begin(double angle) {
    double height = 0;
    for (const Vec3& x : problem_.mesh().nodes) height = std::max(height, x.y());
    return begin_at({0, height / 2}, angle);
  }
  /// An edge crack from a place on the outline.
  fracture::SplitStep begin_at(const Vec2& place, double angle) {
    const Vec2 mouth = in_plane(place), d = along(angle);
    crack.kind = CrackKind::edge;
    crack.mouth = mouth;
    crack.path = {mouth, mouth + 1.5 * board.h() * d};
    crack.length = 1.5 * board.h();
    crack.tips = {{crack.path.back(), d, false}};
    return front.bear(crack, split, nearest(mouth + 0.5 * board.h() * d), destroyed, parts);
  }
  /// An internal one with two tips.
  fracture::SplitStep begin_inside(const Vec2& middle, double angle) {
    const Vec2 at = in_plane(middle), d = along(angle);
    crack.kind = CrackKind::internal;
    crack.path = {at - 1.5 * board.h() * d, at + 1.5 * board.h() * d};
    crack.length = 3 * board.h();
    crack.tips = {{crack.path.front(), -d, false}, {crack.path.back(), d, false}};
    return front.bear(crack, split, nearest(at), destroyed, parts);
  }
  fracture::SplitStep advance(const Vec2& d, std::size_t at = 0) {
    return front.advance(crack, split, at, d, board.h(), destroyed, parts);
  }
  [[nodiscard]] Vec3 tip(std::size_t at = 0) const {
    return board.plane().lift(crack.tips[at].position);
  }
  /// Turned against the last step.
  fracture::SplitStep advance(double angle, std::size_t at = 0) {
    return advance(turned_by(crack.tips[at].direction, angle), at);
  }

  /// Sizes of the groups of elements that hang together by faces that are not open.
  [[nodiscard]] std::map<Index, int> piece_sizes() const {
    std::vector<Index> above(problem_.mesh().tets.size());
    std::iota(above.begin(), above.end(), 0);
    const auto root = [&](Index e) {
      while (above[static_cast<std::size_t>(e)] != e) e = above[static_cast<std::size_t>(e)];
      return e;
    };
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      for (int f = 0; f < 4; ++f) {
        const fracture::Face face{e, f};
        if (body.behind(face) == kNone || body.open(face)) continue;
        const Index a = root(e), b = root(body.behind(face));
        above[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
    std::map<Index, int> sizes;
    for (Index e = 0; e < problem_.tet_count(); ++e) ++sizes[root(e)];
    return sizes;
  }
  [[nodiscard]] int pieces() const { return static_cast<int>(piece_sizes().size()); }

  /// Faces that are open, by both lips.
  [[nodiscard]] std::vector<CrackFace> faces() const {
    std::vector<CrackFace> faces;
    for (const fracture::Face& face : split.faces) {
      CrackFace both{crack.id, body.nodes(face), {}};
      const auto right = body.nodes(body.other_side(face));
      for (std::size_t i = 0; i < 3; ++i) {
        both.right[i] = *std::ranges::find_if(
            right, [&](Index n) { return body.in_mesh(n) == body.in_mesh(both.left[i]); });
      }
      faces.push_back(both);
    }
    return faces;
  }

  /// The mesh as it is now, and where its new nodes lie.
  [[nodiscard]] Mesh mesh() const {
    Mesh mesh = problem_.mesh();
    mesh.tets.assign(body.corners().begin(), body.corners().end());
    for (Index n = problem_.node_count(); n < body.node_count(); ++n) {
      mesh.nodes.push_back(mesh.nodes[static_cast<std::size_t>(body.in_mesh(n))]);
    }
    return mesh;
  }

 private:
  [[nodiscard]] Vec2 in_plane(const Vec2& place) const {
    return board.plane().project(Vec3(place.x(), place.y(), 0));
  }
  [[nodiscard]] Vec2 along(double angle) const {
    return board.plane().project(Vec3(std::cos(angle), std::sin(angle), 0));
  }
  [[nodiscard]] Index nearest(const Vec2& at) const {
    Index nearest = 0;
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      if ((board.centroid(e) - at).norm() < (board.centroid(nearest) - at).norm()) nearest = e;
    }
    return nearest;
  }

  const Problem& problem_;

 public:
  fracture::Board board;
  fracture::SplitBody body;
  fracture::SplitFront front;
  std::vector<std::uint8_t> destroyed;
  fracture::SplitFront::Parts parts = [](Index, Index) { return true; };
  Crack crack;
  fracture::SplitCrack split;
};

}  // namespace sunder::test
