// SPDX-License-Identifier: Apache-2.0
// Which pair of nodes of an interface parts next (method.md "Interfaces"): the one whose traction
// is largest against its strength, and along the edge of what has parted the one whose parting
// would release the most against its energy. What that is the pairs tell that have parted before:
// the force that one has held along the way that its nodes have gone since (virtual crack closure,
// Rybicki and Kanninen, Eng. Fract. Mech. 9, 1977). So the energy that a mesh takes is that of the
// interface although whole nodes part at once.
#pragma once

#include <memory>
#include <vector>

#include "fracture/criterion.hpp"
#include "sunder/interfaces.hpp"

namespace sunder::fracture {

class PartingPairs {
 public:
  /// The problem has interfaces and must outlive it.
  explicit PartingPairs(const Problem& problem);

  struct Next {
    Index element = kNone;  ///< first of the pair's; kNone: none is close to parting
    double ratio = 0;       ///< >= 1: it parts
  };
  /// The pair that is nearest to parting, `worst` by traction alone.
  [[nodiscard]] Next next(const FractureState& state, const Worst& worst);
  /// It parts: its rows, and what the pair shows of later ones.
  void part(const Next& pair, const FractureState& state, std::vector<DestroyedElement>& rows);
  /// The rows alone: in motion what is released is kinetic energy, and no load of the mesh.
  void add_rows(const Next& pair, const FractureState& state,
                std::vector<DestroyedElement>& rows) const;

  /// Pairs that part one after the other without the load growing.
  struct Burst {
    std::vector<std::size_t> pairs;
    std::vector<std::size_t> edge;  ///< ascending: pairs beside what had parted before
    double held = 0;                ///< energy per area of the first as it parted [N/mm]
    double released = 0, area = 0;  ///< by those of the edge [N mm], [mm^2]
    // Of the last pair, whose release is still to be seen: what it held, and its opening.
    double last_held = 0;
    Vec3 opening = Vec3::Zero();
  };
  struct State {
    /// Of each pair that has parted by its law: what its burst released over what its first held;
    /// while that is in work, what was expected of it.
    std::vector<double> release;
    Burst burst;  ///< without pairs: none is in work
  };
  [[nodiscard]] std::shared_ptr<const State> state() const;
  void restore(std::shared_ptr<const State> state);

 private:
  [[nodiscard]] Vec3 opening(std::size_t pair, const FractureState& state) const;
  void see_release(const FractureState& state);
  void end_burst();
  [[nodiscard]] bool at_edge(std::size_t pair, const FractureState& state) const;
  [[nodiscard]] double expected_release(std::size_t pair) const;
  [[nodiscard]] Index first_live(std::size_t pair, const FractureState& state) const;

  const Problem& problem_;
  const Interfaces& interfaces_;
  State now_;
  mutable std::shared_ptr<const State> kept_;  // of now_; null: changed since
};

}  // namespace sunder::fracture
