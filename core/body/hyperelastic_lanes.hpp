// SPDX-License-Identifier: Apache-2.0
// Eight elements of one law at a time: the inner loops of HyperelasticPass.
#pragma once

#include <cstddef>

#include "material/law.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

inline constexpr int kLanes = 8;

/// Elements that share vector registers.
struct alignas(64) ElementBlock {
  double gradient[9][kLanes];  ///< of corners 1..3: 3 * (corner - 1) + axis [1/mm]
  double mu[kLanes], lambda[kLanes];
  double volume[kLanes];
  double live[kLanes];      ///< 1; 0: destroyed, or a filler
  double counts[kLanes];    ///< 1: live and not cut off
  Index corner[4][kLanes];  ///< 3 * node
  Index element[kLanes];    ///< kNone: a filler
};

/// Numbers of a block's elements.
template <int kCount>
using Lanes = double[kCount][kLanes];

/// What is stored of each element; null: nothing.
struct LaneOutputs {
  double* forces = nullptr;  ///< of a block: axis, corner, lane
  /// Where volumes are pooled, of a block: the pressures of its elements' patches.
  const double* pressure = nullptr;
  Voigt* stress = nullptr;   ///< of each element, by its id
  bool largest = false;      ///< the largest norm of stress is asked for
  bool deformation = false;  ///< GroupFound's strain, turn and inverted are
  StressMeasure measure = StressMeasure::cauchy;
};

/// Blocks of one law and one kind, one after the other.
struct ElementGroup {
  static constexpr std::size_t kMost = 8;
  const Law* law;
  std::size_t first = 0, count = 0;  ///< blocks
  bool pooled = false;               ///< their volume is their patch's
  bool fibres = false;               ///< theirs have some
  bool layer = false;  ///< of interfaces: their stress is Biot's, their deformation does not count
};

/// Of a group's live elements, those in one lane together.
struct alignas(64) GroupFound {
  double energy[kLanes];    ///< sum of V W
  double largest[kLanes];   ///< squared norm of stress
  double check[kLanes];     ///< no number where a stress is not finite
  double strain[kLanes];    ///< |principal value of S - I|, to 1e-7
  double turn[kLanes];      ///< 1 - cos of the rotation
  double inverted[kLanes];  ///< how many
  std::size_t repaired;     ///< elements whose rotation took the scalar way
};

/// `blocks` and, where asked for, `to.forces` are those of the group's first.
void run_group(const Problem& problem, const ElementGroup& group, const ElementBlock* blocks,
               const double* u, const LaneOutputs& to, GroupFound& found);

/// J of each of a group's elements as its law measures it, block by block.
void find_volumes(const ElementGroup& group, const ElementBlock* blocks, const double* u,
                  double* volumes);

// hyperelastic_pass.cpp: for lanes that the loops leave to the scalar laws.
struct RotationInLanes {
  Lanes<9> f, r;
  double trace[kLanes];
};
void rotate_by_singular_values(RotationInLanes& of, unsigned lanes);
struct ResponseInLanes {
  Lanes<9> f, p;
  double energy[kLanes];
};
/// `pressure`: of its elements' patches, where their volume is pooled; else null.
void respond_by_law(const Problem& problem, const Law& law, const ElementBlock& block,
                    const double* pressure, ResponseInLanes& of);
/// J of a block's live elements at F; of the others 0.
void ratios_by_law(const Law& law, const ElementBlock& block, const Lanes<9>& f, double* volumes);

}  // namespace sunder::fem
