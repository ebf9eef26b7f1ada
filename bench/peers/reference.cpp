// SPDX-License-Identifier: Apache-2.0
#include "bench/peers/reference.hpp"

#include <stdexcept>

#include "bench/cholmod_data.hpp"
#include "bench/peers/peer.hpp"
#include "body/assembly.hpp"
#include "body/element.hpp"
#include "body/pieces.hpp"
#include "support/accuracy.hpp"

namespace sunder::bench {
namespace {

/// x = A^-1 f, refined once by f - K x taken element by element.
Eigen::VectorXd refined_solution(const TearingBoard& board, std::span<const Index> destroyed,
                                 std::span<const double> scale) {
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  cholmod_sparse* a = to_cholmod(damaged_stiffness(*board.problem, destroyed), -1, common);
  cholmod_factor* l = cholmod_analyze(a, &common);
  cholmod_factorize(a, l, &common);
  const Eigen::VectorXd f = load_vector(board);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(f.size()), kx = x;
  cholmod_dense* b = cholmod_zeros(a->nrow, 1, CHOLMOD_REAL, &common);
  std::vector<double> nodal(board.problem->dofs().size());
  for (int pass = 0; pass < 2; ++pass) {
    fem::apply_stiffness(*board.problem, scale, to_nodes(*board.problem, x), nodal);
    fem::gather(*board.problem, nodal, {kx.data(), static_cast<std::size_t>(kx.size())});
    Eigen::Map<Eigen::VectorXd>(static_cast<double*>(b->x), f.size()) = f - kx;
    cholmod_dense* dx = cholmod_solve(CHOLMOD_A, l, b, &common);
    x += Eigen::Map<Eigen::VectorXd>(static_cast<double*>(dx->x), f.size());
    cholmod_free_dense(&dx, &common);
  }
  const bool good = common.status == CHOLMOD_OK;
  cholmod_free_dense(&b, &common);
  cholmod_free_factor(&l, &common);
  cholmod_free_sparse(&a, &common);
  cholmod_finish(&common);
  if (!good) throw std::runtime_error("the yardstick's factorisation failed");
  return x;
}

}  // namespace

std::vector<double> to_nodes(const Problem& problem, const Eigen::VectorXd& x) {
  std::vector<double> u(problem.dofs().size());
  fem::scatter(problem, {x.data(), static_cast<std::size_t>(x.size())}, u);
  return u;
}

std::vector<Voigt> plain_stress(const Problem& problem, std::span<const double> scale,
                                std::span<const double> u) {
  std::vector<Voigt> all(problem.mesh().tets.size());
  for (Index e = 0; e < problem.tet_count(); ++e) {
    all[static_cast<std::size_t>(e)] = scale[static_cast<std::size_t>(e)] *
                                       fem::stress(problem.shape(e), problem.small_strain(e),
                                                   fem::corner_displacement(problem.mesh(), e, u));
  }
  return all;
}

Damaged::Damaged(const TearingBoard& board, std::span<const Index> destroyed)
    : ignored_(board.problem->mesh().tets.size(), 0) {
  const Problem& problem = *board.problem;
  std::vector<double> scale(ignored_.size(), 1.0);
  for (Index e : destroyed) {
    ignored_[static_cast<std::size_t>(e)] = 1;
    scale[static_cast<std::size_t>(e)] = problem.scene().fracture.alpha;
  }
  u_ = to_nodes(problem, refined_solution(board, destroyed, scale));
  stress_ = plain_stress(problem, scale, u_);
  for (const auto& piece : find_loose_parts(problem, ignored_).pieces) {
    for (Index e : piece) ignored_[static_cast<std::size_t>(e)] = 1;
  }
}

Accuracy Damaged::accuracy(const Problem& problem, std::span<const double> u,
                           std::span<const Voigt> stress) const {
  return {test::displacement_error(problem.mesh(), ignored_, u, u_),
          test::stress_error(ignored_, stress, stress_)};
}

}  // namespace sunder::bench
