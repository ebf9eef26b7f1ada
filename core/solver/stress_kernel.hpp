// SPDX-License-Identifier: Apache-2.0
// Element stress, eight elements at a time, with what a frame wants to know of it: the largest
// norm, a bound of each element's yield ratio, and the forces K u that the stress exerts.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "linear_algebra/workers.hpp"
#include "machine/compiler.hpp"
#include "solver/deformation_search.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

class StressKernel {
 public:
  static constexpr int kLanes = 8;

  /// Over all elements, or over those listed (ascending). `threads` 0: as many as the machine
  /// offers, if there are elements enough to be worth it. The bits do not depend on it.
  StressKernel(std::shared_ptr<const Problem> problem, std::vector<Index> elements, int threads);

  /// Follows the removal of elements: their stress is scaled and no longer counts.
  void destroy(std::span<const Index> elements);
  /// Patches of pooled volume are from now on those of these forms, as after each change().
  void take_pools(const fem::Forms& forms);
  /// Follows the return of elements to what they were at first, but for their corners: those are
  /// as the forms have them.
  void revive(std::span<const Index> elements, const fem::Forms& forms);

  /// Follows elements that come as they were but for their corners.
  void change(std::span<const fem::Coming> come, const fem::Forms& forms);

  /// Stress a_e D B u from the displacement at all nodes (3 * nodes), bit by bit that of
  /// fem::stress, one value per listed element in that order; empty `stress`: not stored. Returns
  /// the largest norm of the tensor over live elements; not finite when one of them is not.
  double run(std::span<const double> u, std::span<Voigt> stress);
  /// The largest norm alone.
  [[nodiscard]] double largest(std::span<const double> u);

  /// Worst ratios of the stress that the last run() stored.
  [[nodiscard]] StressSummary summarize(std::span<const std::uint8_t> excluded,
                                        std::span<const Voigt> stress) const;

  /// Of the displacement that the last run() got, over live elements that are not cut off; the
  /// rotation to 0.1 %. Needs keep_deformation().
  [[nodiscard]] Deformation deformation(std::span<const double> u) const;
  /// Takes elements out of deformation().
  void cut_off(std::span<const Index> elements);
  /// Those taken out, per element; empty: deformation() is not asked for.
  [[nodiscard]] const std::vector<std::uint8_t>& taken_out() const { return cut_off_; }
  void take_out_only(const std::vector<std::uint8_t>& elements) { cut_off_ = elements; }

  /// Where run() puts the stress of an element; kNone: it is not listed.
  [[nodiscard]] Index place(Index element) const { return place_[element]; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] int threads() const { return workers_->count(); }
  /// Forces K u on all nodes (3 * nodes), of the displacement that the last run() got. Those on a
  /// node of the mesh are the whole of what acts there, new nodes included (method.md 14).
  void nodal_forces(std::span<double> forces);

  /// Makes run() keep what summarize() reads.
  void keep_bounds();
  /// Makes run() keep what deformation() reads.
  void keep_deformation();
  /// Makes run() keep what nodal_forces() sums up; for a kernel over all elements.
  void keep_forces();
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct alignas(64) Block {
    double gradient[9][kLanes];  // of corners 1..3: 3 * (corner - 1) + axis
    double mu[kLanes], lambda[kLanes];
    double scale[kLanes];     // a_e
    double live[kLanes];      // 1/3: tr E times it is the mean strain; 0: destroyed, does not count
    double softness[kLanes];  // 1 / (2 mu^2); 0 where destroyed
    double volume[kLanes];
    double strength[kLanes];  // 1 / yield^2 of live breakable elements, else 0
    Index corner[4][kLanes];  // 3 * node
    Index element[kLanes];    // kNone: filler

    /// Displacement of corners 1..3 against corner 0: 3 * (corner - 1) + axis.
    SUNDER_FORCE_INLINE void differences(const double* u, double (&d)[9][kLanes]) const {
      for (int axis = 0; axis < 3; ++axis) {
        for (int l = 0; l < kLanes; ++l) {
          const double u0 = u[corner[0][l] + axis];
          d[axis][l] = u[corner[1][l] + axis] - u0;
          d[3 + axis][l] = u[corner[2][l] + axis] - u0;
          d[6 + axis][l] = u[corner[3][l] + axis] - u0;
        }
      }
    }
  };
  /// Of the live elements in one lane of kGroup blocks, of E = sym grad u with the mean m = tr E /
  /// 3: largest m, -m, |E - m I|^2 and |curl u|^2 / 3, none under 0.
  struct alignas(64) GroupBounds {
    double stretch[kLanes], squeeze[kLanes], deviator[kLanes], curl[kLanes];
  };
  static constexpr std::size_t kGroup = 8;
  /// Of each lane, the largest that |E|^2 and |curl u|^2 / 3 may be.
  struct Largest {
    double strain[kLanes], curl[kLanes];
  };
  struct Partial {
    double largest = 0, check = 0;
  };
  /// What run_blocks() stores; null: not stored.
  struct Stores {
    Voigt* stress = nullptr;
    double* bounds = nullptr;
    double* forces = nullptr;
    GroupBounds* groups = nullptr;
    bool principal = false;             // the bounds are of the largest principal stress
    const double* pressures = nullptr;  // read: of pooled volume, at each place
  };
  void bring(Block& block, std::size_t lane, Index element) const;
  static void run_blocks(const Block* blocks, std::size_t count, const double* u, Stores to,
                         Partial& partial);
  static void run_and_bound(const Block* blocks, std::size_t count, const double* u, Stores to,
                            Partial& partial);
  static void run_pooled(const Block* blocks, std::size_t count, const double* u, Stores to,
                         Partial& partial);
  static void run_pooled_and_bound(const Block* blocks, std::size_t count, const double* u,
                                   Stores to, Partial& partial);
  void find_pressures(std::span<const double> u);
  template <bool kMeasured, bool kPooled>
  static void run_all(const Block* blocks, std::size_t count, const double* u, Stores to,
                      Partial& partial);
  [[nodiscard]] double run_storing(std::span<const double> u, Stores to);
  [[nodiscard]] Worst worst(std::span<const std::uint8_t> excluded,
                            std::span<const Voigt> stress) const;
  [[nodiscard]] double least_bound() const;
  // stress_kernel_deformation.cpp
  /// A lane of a group.
  struct Place {
    std::size_t group = 0;
    int lane = 0;
  };
  static double strain_bound(const GroupBounds& of, std::ptrdiff_t lane);
  static Largest largest_bounds(const GroupBounds* groups, std::size_t count);
  template <class Bound>
  [[nodiscard]] Place place_of(const double (&largest)[kLanes], Bound&& bound) const;
  static bool any_over(const GroupBounds* groups, std::size_t count,
                       const DeformationSearch::Limits& limits);
  [[nodiscard]] std::size_t next_over(std::size_t from,
                                      const DeformationSearch::Limits& limits) const;
  static unsigned lanes_over(const GroupBounds& group, const DeformationSearch::Limits& limits);
  static unsigned lanes_over(const Block& block, const double* u,
                             const DeformationSearch::Limits& limits);
  [[nodiscard]] std::span<const Block> blocks_of(std::size_t group) const;
  [[nodiscard]] bool counts(const Block& block, int lane) const;
  static Mat3 gradient_of(const Block& block, int lane, std::span<const double> u);
  template <class Measure>
  [[nodiscard]] Mat3 most_by(Measure&& measure, Place at, std::span<const double> u) const;
  void take(DeformationSearch& search, std::size_t group, std::span<const double> u) const;

  std::shared_ptr<const Problem> problem_;
  std::shared_ptr<const fem::Pools> pools_;  // as damage has split them; null: as the problem has
  std::size_t size_ = 0;                     // listed elements
  std::vector<Block> blocks_;
  std::vector<Index> place_;    // of each element, kNone: not in here
  std::vector<double> bounds_;  // of ratios, squared and in order: J_2 / yield^2 for shear
  std::vector<GroupBounds> groups_;
  double rounding_ = 0;                // of the strains in groups_, a share of the largest
  std::vector<std::uint8_t> cut_off_;  // per element; empty: deformation() is not asked for
  // Forces on the corners of a block's elements: axis, corner, lane; of each node, where in there
  // its elements' forces on axis x begin.
  std::vector<double> forces_;
  std::vector<std::size_t> node_begin_;
  std::vector<Index> at_node_;
  std::vector<Index> changed_;  // elements with corners at new nodes, ascending
  std::vector<Partial> partials_;
  // Of pooled volume, none without: a_e V_e tr eps at each place, then the pressure there.
  std::vector<double> pooled_, pooled_volume_;  // V_e there, 0 of others
  std::unique_ptr<Workers> workers_;
};

}  // namespace sunder::solver
