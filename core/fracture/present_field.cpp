// SPDX-License-Identifier: Apache-2.0
#include "fracture/present_field.hpp"

#include <algorithm>

#include "body/law_stress.hpp"

namespace sunder::fracture {

PresentField::PresentField(const Problem& problem, const Board& board)
    : problem_(problem), board_(board), patches_(problem) {
  if (problem.scene().fracture.sigma0 != RemoteStress::present) return;
  const std::size_t most = board.most_within(kNeighbourhood * board.h());
  near_.reserve(most);
  corners_.reserve(4 * most);
  moved_.reserve(4 * most);
}

std::optional<InPlane> PresentField::at(const Vec2& p) const {
  board_.elements_within(p, kNeighbourhood * board_.h(), near_);
  std::erase_if(near_, [&](Index e) { return !problem_.destructible(e) || destroyed_[e]; });
  if (near_.empty()) return std::nullopt;
  corners_.clear();
  for (Index e : near_)
    corners_.insert(corners_.end(), problem_.mesh().tets[e].begin(), problem_.mesh().tets[e].end());
  moved_.resize(corners_.size());
  (*displacement_)(corners_, moved_);

  patches_.read(near_, {destroyed_, *displacement_, {}, pools_});
  Voigt sum = Voigt::Zero();
  double volume = 0;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    const TetShape& shape = problem_.shape(near_[i]);
    Eigen::Matrix<double, 3, 4> u;
    for (int corner = 0; corner < 4; ++corner)
      u.col(corner) = moved_[4 * i + static_cast<std::size_t>(corner)];
    sum += shape.volume * stress_with(patches_, problem_, i, near_[i], u);
    volume += shape.volume;
  }
  return in_plane(sum / volume, board_.plane());
}

}  // namespace sunder::fracture
