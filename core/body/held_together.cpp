// SPDX-License-Identifier: Apache-2.0
#include "body/held_together.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace sunder::fem {
namespace {

// Of the scaled Gram matrix of what holds the pieces, relative to its largest eigenvalue.
constexpr double kRigidTolerance = 1e-10;

class Pieces {
 public:
  explicit Pieces(const Forms& forms) : forms_(forms), problem_(forms.problem()) {
    for (Index e = 0; e < forms.element_count(); ++e) {
      if (!(forms.share(e) > 0)) continue;
      const auto form = forms.came().find(e);
      elements_.push_back(form == forms.came().end()
                              ? problem_.mesh().tets[static_cast<std::size_t>(e)]
                              : form->second.corners);
    }
    join_at_faces();
    find_frames();
  }

  [[nodiscard]] bool held() {
    const Eigen::Index size = 6 * static_cast<Eigen::Index>(centre_.size());
    gram_.setZero(size, size);
    first_.assign(3 * static_cast<std::size_t>(forms_.node_count()), kNone);
    hold_anchors();
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      for (Index n : elements_[e]) {
        for (int axis = 0; axis < 3; ++axis) meet(piece_[e], n, axis);
      }
    }
    for (Index i = 0; i < 3 * problem_.node_count(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (problem_.dofs()[at] != kNone && first_[at] == kNone) return false;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram_, Eigen::EigenvaluesOnly);
    return solver.eigenvalues()[0] > kRigidTolerance * solver.eigenvalues()[size - 1];
  }

 private:
  static constexpr Index kHeld = -2;  // among the pieces of first_: what does not move

  /// 3 node + axis of what moves with a node on an axis.
  [[nodiscard]] Index mover(Index node, int axis) const {
    const Index added = node - problem_.node_count();
    if (added < 0) return 3 * node + axis;
    const NewNode& own = forms_.new_nodes()[static_cast<std::size_t>(added)];
    return 3 * (own.axes.has(axis) ? node : own.parent) + axis;
  }

  [[nodiscard]] const Vec3& place(Index node) const {
    const Index added = node - problem_.node_count();
    const Index of = added < 0 ? node : forms_.new_nodes()[static_cast<std::size_t>(added)].parent;
    return problem_.mesh().nodes[static_cast<std::size_t>(of)];
  }

  Index root(Index e) {
    while (above_[static_cast<std::size_t>(e)] != e) {
      above_[static_cast<std::size_t>(e)] =
          above_[static_cast<std::size_t>(above_[static_cast<std::size_t>(e)])];
      e = above_[static_cast<std::size_t>(e)];
    }
    return e;
  }

  /// Numbers the pieces by their first element.
  void join_at_faces() {
    above_.resize(elements_.size());
    std::iota(above_.begin(), above_.end(), 0);
    std::vector<std::pair<std::array<Index, 3>, Index>> faces;
    faces.reserve(4 * elements_.size());
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      for (std::size_t left_out = 0; left_out < 4; ++left_out) {
        std::array<Index, 3> face{};
        for (std::size_t a = 0, i = 0; a < 4; ++a) {
          if (a != left_out) face[i++] = elements_[e][a];
        }
        std::sort(face.begin(), face.end());
        faces.emplace_back(face, static_cast<Index>(e));
      }
    }
    std::sort(faces.begin(), faces.end());
    for (std::size_t i = 1; i < faces.size(); ++i) {
      if (faces[i].first != faces[i - 1].first) continue;
      const Index a = root(faces[i - 1].second), b = root(faces[i].second);
      above_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    Index count = 0;
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const Index first = root(static_cast<Index>(e));
      piece_.push_back(first == static_cast<Index>(e) ? count++
                                                      : piece_[static_cast<std::size_t>(first)]);
    }
    centre_.assign(static_cast<std::size_t>(count), Vec3::Zero());
    size_.assign(static_cast<std::size_t>(count), 0);
  }

  /// A piece's motion is counted at its middle, and turning in the unit of its size.
  void find_frames() {
    std::vector<double> corners(centre_.size(), 0);
    const auto for_corners = [this](auto&& act) {
      for (std::size_t e = 0; e < elements_.size(); ++e) {
        for (Index n : elements_[e]) act(static_cast<std::size_t>(piece_[e]), place(n));
      }
    };
    for_corners([&](std::size_t piece, const Vec3& x) {
      centre_[piece] += x;
      corners[piece] += 1;
    });
    for (std::size_t p = 0; p < centre_.size(); ++p) centre_[p] /= corners[p];
    for_corners([&](std::size_t piece, const Vec3& x) {
      size_[piece] = std::max(size_[piece], (x - centre_[piece]).norm());
    });
  }

  /// Springs that stand in for supports.
  void hold_anchors() {
    std::vector<Index> anchored(problem_.anchored_dofs().begin(), problem_.anchored_dofs().end());
    std::sort(anchored.begin(), anchored.end());
    for (Index i = 0; i < 3 * problem_.node_count(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Index dof = problem_.dofs()[at];
      if (dof == kNone || std::binary_search(anchored.begin(), anchored.end(), dof)) {
        first_[at] = kHeld;
      }
    }
  }

  /// A piece has a node: on each axis it moves as the first piece there does, or not at all.
  void meet(Index piece, Index node, int axis) {
    Index& first = first_[static_cast<std::size_t>(mover(node, axis))];
    if (first == kNone) first = piece;
    if (first == piece) return;
    const std::array<Index, 2> pieces{piece, first};
    std::array<Eigen::Matrix<double, 6, 1>, 2> rows;
    const std::size_t count = first == kHeld ? 1 : 2;
    for (std::size_t i = 0; i < count; ++i) {
      const auto p = static_cast<std::size_t>(pieces[i]);
      const Vec3 unit = Vec3::Unit(axis);
      rows[i] << unit, ((place(node) - centre_[p]) / size_[p]).cross(unit);
      if (i == 1) rows[i] = -rows[i];
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        gram_.block<6, 6>(6 * pieces[i], 6 * pieces[j]) += rows[i] * rows[j].transpose();
      }
    }
  }

  const Forms& forms_;
  const Problem& problem_;
  std::vector<std::array<Index, 4>> elements_;  // corners
  std::vector<Index> above_, piece_;            // of each element
  std::vector<Vec3> centre_;                    // of each piece
  std::vector<double> size_;
  std::vector<Index> first_;  // piece that was first at each mover
  Eigen::MatrixXd gram_;
};

}  // namespace

bool held_together(const Forms& forms) { return Pieces(forms).held(); }

bool holds_together(const Forms& forms, const Event& change) {
  if (change.come.empty() || change.held) return true;
  Forms after = forms;
  after.add(change.nodes);
  after.follow(change);
  return held_together(after);
}

}  // namespace sunder::fem
