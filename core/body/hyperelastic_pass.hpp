// SPDX-License-Identifier: Apache-2.0
// One pass over the elements of a body at finite deformation, eight at a time: its energy and
// internal forces as hyperelastic.hpp defines them, the stress that a criterion reads, and how far
// elements are deformed. The bits depend neither on the number of threads nor on the machine's
// vectors.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/hyperelastic.hpp"
#include "body/hyperelastic_lanes.hpp"
#include "linear_algebra/workers.hpp"
#include "sunder/backend.hpp"

namespace sunder::fem {

class HyperelasticPass {
 public:
  /// What a run is asked for besides the energy. Sizes are 3 * nodes and elements; empty: not
  /// stored.
  struct Wanted {
    std::span<double> forces = {};
    /// Of destroyed elements 0, of those in no state of their law no numbers.
    std::span<Voigt> stress = {};
    std::optional<StressMeasure> measure = {};  ///< nothing: no stress, and no largest one
    bool deformation = false;
  };
  struct Found {
    double energy = 0;  ///< infinite where a law knows no such state [N mm]
    /// Largest norm of the stress tensor over live elements that are not cut off; no number where
    /// one of them is none.
    double largest = 0;
    /// Of the same elements: the principal value of S - I (F = R S), the angle of R, det F <= 0.
    Deformation deformation;
  };

  /// The problem and what `body` refers to must outlive it. `threads` 0: as many as the machine
  /// offers, if there are elements enough to be worth it.
  explicit HyperelasticPass(const HyperelasticBody& body, int threads = 0);

  /// As energy(body, u).
  [[nodiscard]] double energy(std::span<const double> u) { return run(u, {}).energy; }
  /// As internal_forces(body, u, f): the same sums, of terms that differ by rounding. The one with
  /// stresses, and element_stresses(), are run().
  double internal_forces(std::span<const double> u, std::span<double> f) {
    return run(u, {.forces = f}).energy;
  }
  /// Everything at once.
  Found run(std::span<const double> u, const Wanted& wanted);

  /// These add nothing any more.
  void destroy(std::span<const Index> elements);
  /// Reads anew from the body which elements are destroyed and which law each volume has.
  void body_changed();
  /// Patches of pooled volume are these from now on, as HyperelasticBody::split.
  void split_pools(std::shared_ptr<const Pools> split);
  /// These no longer count in Found::largest and Found::deformation.
  void cut_off(std::span<const Index> elements);

  /// Per element 1: its volume no longer counts in its patch's, where that is pooled. Its own
  /// stress and forces mean nothing then.
  void leave_alone(std::span<const std::uint8_t> elements);

  [[nodiscard]] int threads() const { return workers_->count(); }
  /// Elements of the last run that took the scalar way to their rotation.
  [[nodiscard]] std::size_t repaired() const { return repaired_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  void arrange();
  void arrange(const ElementGroup& kind);
  void pool_volumes(std::span<const double> u);
  void pool_volume(Index patch);
  void count_in(ElementBlock& block, int lane) const;
  void place_forces();
  void sum_forces(std::span<double> forces);
  [[nodiscard]] Found sum_up(const Wanted& wanted, std::span<const double> u);
  [[nodiscard]] Deformation deformation(std::span<const double> u) const;
  template <class Measure>
  [[nodiscard]] double most_by(const double (GroupFound::*bound)[kLanes], Measure&& measure) const;

  HyperelasticBody body_;
  std::vector<const Law*> laws_;  // of volumes, as the blocks have them
  std::vector<ElementBlock> blocks_;
  std::vector<ElementGroup> groups_;
  std::vector<GroupFound> found_;      // of each group
  std::vector<Index> place_;           // of each element: block * kLanes + lane
  std::vector<std::uint8_t> cut_off_;  // per element
  std::vector<std::uint8_t> alone_;    // per element
  // Where volumes are pooled, per lane of a block: J, and the patch's pressure; per patch V_p U.
  std::vector<double> volumes_, pressure_, patches_;
  // Forces on the corners of a block's elements: axis, corner, lane; a block of zeros at the end.
  std::vector<double> forces_;
  // Nodes with about as many elements, four at a time: step by step the places in forces_ of what
  // acts on each along axis x, by ascending element, then of zeros.
  struct FourNodes {
    Index node[4];           // kNone: a filler
    std::size_t first, end;  // of four places each
  };
  std::vector<FourNodes> nodes_;
  std::vector<std::array<Index, 4>> at_nodes_;
  std::size_t repaired_ = 0;
  std::unique_ptr<Workers> workers_;
};

}  // namespace sunder::fem
