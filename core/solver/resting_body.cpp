// SPDX-License-Identifier: Apache-2.0
#include "solver/resting_body.hpp"

#include <algorithm>

#include "body/pools.hpp"

namespace sunder::solver {

RestingBody::RestingBody(const fem::HyperelasticBody& body, Loose loose)
    : body_(body),
      loose_(loose),
      search_(body.problem),
      out_(static_cast<std::size_t>(body.problem.tet_count()), 0),
      frozen_(static_cast<std::size_t>(body.problem.dof_count())),
      flying_(frozen_.size()),
      resting_{body.problem, body.law_of_volume, out_} {
  look();
}

void RestingBody::look() {
  const Problem& problem = body_.problem;
  std::ranges::fill(out_, std::uint8_t{0});
  std::ranges::copy(body_.destroyed, out_.begin());
  search_.look(out_);
  const bool frozen = loose_ == Loose::frozen;
  if (frozen) parts_ = {search_.isolated_nodes(), search_.pieces(), search_.elements_cut_off()};
  std::vector<std::uint8_t>& loose = frozen ? frozen_ : flying_;
  std::ranges::fill(loose, std::uint8_t{1});
  for (Index e = 0; e < problem.tet_count(); ++e) {
    if (out_[e]) continue;
    if (search_.piece_of(e) != kNone) {
      out_[e] = frozen;
      continue;
    }
    for (Index n : problem.mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        if (d != kNone) loose[d] = 0;
      }
    }
  }
  if (problem.pools()) split_pools();
}

/// The same object as long as live elements share the same patches.
void RestingBody::split_pools() {
  const fem::Pools& pools = *resting_.problem.pools();
  auto split = pools.split([this](Index e) { return out_[e] ? kNone : search_.body_of(e); });
  const fem::Pools &now = split ? *split : pools, &before = *resting_.pools();
  Index e = 0;
  while (e < resting_.problem.tet_count() && (out_[e] || now.of(e) == before.of(e))) ++e;
  if (e < resting_.problem.tet_count()) resting_.split = std::move(split);
}

}  // namespace sunder::solver
