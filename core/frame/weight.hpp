// SPDX-License-Identifier: Apache-2.0
// Gravity in statics: the weight of the nodes that something holds. In motion it is part of the
// equation of motion (solver/finite_motion.hpp).
#pragma once

#include <span>
#include <vector>

#include "body/pieces.hpp"
#include "sunder/backend.hpp"

namespace sunder {

class Weight {
 public:
  /// Throws InputError where a material has no density.
  explicit Weight(const Problem& problem);

  /// What is cut off weighs nothing any more: nothing would hold it up but the small stiffness
  /// that destroyed elements keep.
  void look(std::span<const std::uint8_t> destroyed);
  /// Unknowns that the scene's grips hold, ascending (at first all of them): a part of their
  /// reactions, no force on the body. And nodes that a host holds. What they hold up weighs.
  void hold(std::span<const Index> unknowns, std::span<const Index> nodes);

  /// The intact body's, and the present one's, added to the forces of a load.
  void add_intact(Load& load) { add(intact_, load); }
  void add_present(Load& load) { add(present_, load); }

  /// On what a grip or a support holds along an axis [N]: a part of their reactions.
  [[nodiscard]] double of(Index node, int axis) const {
    return weighs_[static_cast<std::size_t>(node)]
               ? mass_[static_cast<std::size_t>(node)] * gravity_[axis]
               : 0;
  }

 private:
  void add(const Load& weight, Load& load);
  void collect(Load& weight) const;

  const Problem& problem_;
  Vec3 gravity_;
  std::vector<double> mass_;          // per node [t]
  std::vector<std::uint8_t> weighs_;  // per node
  std::vector<Index> gripped_;        // by the scene's grips
  LooseSearch search_;
  std::ptrdiff_t destroyed_ = 0;  // elements at the last look
  Load intact_, present_, sum_;
};

}  // namespace sunder
