// SPDX-License-Identifier: Apache-2.0
// Vertex block descent (Chen, Liu, Yang and Yuksel 2024): sweeps over the nodes, colour by colour,
// each node moved by a Newton step of its own three unknowns.
#include <Eigen/Cholesky>

#include "bench/motion_peers/motion_peer.hpp"
#include "body/deformation.hpp"
#include "material/singular_values.hpp"

namespace sunder::bench {
namespace {

constexpr int kMost = 400, kLook = 4;  // sweeps; between looks at the residual
constexpr double kChebyshev = 0.95;    // their acceleration's estimate of the spectral radius

class MotionVertexBlocks : public MotionPeer {
 public:
  MotionVertexBlocks(const MotionBoard& board, double tolerance)
      : MotionPeer(board, tolerance, kMost) {
    const Problem& problem = board.problem;
    around_.resize(problem.mesh().nodes.size());
    for (Index e = 0; e < problem.tet_count(); ++e) {
      for (int a = 0; a < 4; ++a) around_[problem.mesh().tets[e][a]].push_back({e, a});
    }
    colour();
  }

 private:
  struct Corner {
    Index element;
    int place;
  };

  /// Greedy: neighbours differ.
  void colour() {
    const Mesh& mesh = board().problem.mesh();
    std::vector<int> of(mesh.nodes.size(), -1);
    for (Index n = 0; n < mesh.node_count(); ++n) {
      const bool moves =
          board().problem.dof(n, 0) != kNone &&
          !std::ranges::binary_search(board().problem.gripped_dofs(), board().problem.dof(n, 0));
      if (!moves) continue;
      std::vector<std::uint8_t> taken(colours_.size() + 1, 0);
      for (const Corner& c : around_[n]) {
        for (Index m : mesh.tets[c.element]) {
          if (of[m] >= 0) taken[static_cast<std::size_t>(of[m])] = 1;
        }
      }
      const auto free = std::ranges::find(taken, 0) - taken.begin();
      of[n] = static_cast<int>(free);
      if (static_cast<std::size_t>(free) == colours_.size()) colours_.emplace_back();
      colours_[static_cast<std::size_t>(free)].push_back(n);
    }
  }

  void move(Index n, const solver::FiniteTarget& target, std::vector<double>& u) const {
    const Problem& problem = board().problem;
    const double inertia = target.inertia.of(problem.dof(n, 0));
    const Vec3 at(&u[3 * n]), ahead(&(*target.ahead)[3 * n]);
    Vec3 force = inertia * (at - ahead);
    Mat3 h = inertia * Mat3::Identity();
    for (const Corner& c : around_[n]) {
      if (!body().live(c.element)) continue;
      const auto& law = problem.small_strain(c.element);
      const TetShape& shape = problem.shape(c.element);
      const Mat3 f = Mat3::Identity() + fem::displacement_gradient(problem, c.element, u);
      const Mat3 r = nearest_rotation(f);
      const Vec3 g = shape.gradient.col(c.place), turned = r * g;
      const Mat3 p = 2 * law.mu * (f - r) + law.lambda * ((r.transpose() * f).trace() - 3) * r;
      force += shape.volume * (p * g);
      // Without the rotation's own derivative, which leaves it positive definite.
      h += shape.volume * (2 * law.mu * g.squaredNorm() * Mat3::Identity() +
                           law.lambda * turned * turned.transpose());
    }
    const Vec3 du = -h.llt().solve(force);
    for (int axis = 0; axis < 3; ++axis) u[3 * n + axis] += du[axis];
  }

  MotionSolved minimise(const solver::FiniteTarget& target) override {
    MotionSolved solved;
    std::vector<double>& u = state().u;
    std::vector<double> before = u, last = u;
    double omega = 1;
    while (!at_end() && solved.iterations < most()) {
      for (int i = 0; i < kLook; ++i) {
        last = u;
        for (const auto& nodes : colours_) {
          for (Index n : nodes) move(n, target, u);
        }
        omega = solved.iterations == 0   ? 1
                : solved.iterations == 1 ? 2 / (2 - kChebyshev * kChebyshev)
                                         : 4 / (4 - kChebyshev * kChebyshev * omega);
        for (std::size_t k = 0; k < u.size(); ++k) u[k] = omega * (u[k] - before[k]) + before[k];
        before = last;
        ++solved.iterations;
      }
      potential().evaluate(target, false, state());
    }
    solved.ended = at_end();
    return solved;
  }

  std::vector<std::vector<Corner>> around_;  // of each node
  std::vector<std::vector<Index>> colours_;
};

}  // namespace

MotionKind motion_vertex_blocks() {
  return {"vertex block descent",
          "sweeps over the nodes by colours, a Newton step of three unknowns each, Chebyshev "
          "acceleration of .95 (Chen, Liu, Yang and Yuksel 2024), one thread; at most 400 sweeps",
          [](const MotionBoard& board, double tolerance) -> std::unique_ptr<MotionPeer> {
            return std::make_unique<MotionVertexBlocks>(board, tolerance);
          }};
}

}  // namespace sunder::bench
