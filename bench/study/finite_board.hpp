// SPDX-License-Identifier: Apache-2.0
// The body of the stability study at finite deformation: a board between two hands that hold its
// edges as solids, with one knob per difficulty, and how the hands move.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sunder/problem.hpp"

namespace sunder::bench {

/// Families of fibres, in all tissue but the frames: along the board's diagonal, the second one
/// along the other.
struct FibreDifficulty {
  int families = 1;
  double k1 = 50;  ///< [MPa]; law linear: Young's modulus along, a fifth of it in shear
  double k2 = 10, dispersion = 0;
};

/// Across the board's middle.
struct InterfaceDifficulty {
  double strength = 1, energy = 1e-2;  ///< [MPa], [N/mm]
};

struct FiniteCell {
  std::string study;
  MaterialLaw law = MaterialLaw::corotated;
  double contrast = 1, poisson = 0.45, sliver = 1;
  std::string motion;
  bool pooled = false;
  std::optional<FibreDifficulty> fibres = {};
  std::optional<InterfaceDifficulty> interface = {};
};

/// Where the lower hand is, and the upper one where it moves too.
struct Hands {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  Vec3 lower_turn = Vec3::Zero(), upper_turn = Vec3::Zero();  // [deg]
};
struct Step {
  double amount;  ///< as the motion counts it
  Hands hands;
  std::vector<Index> destroyed;  ///< before it
  bool rigid = false;            ///< the body as a whole: it has no stress
};

/// Breadth and depth of the board [mm].
constexpr double kFiniteSide = 50, kFiniteDepth = 5;

/// 6 x 6 cells of six tetrahedra, frames at both hands. `solver`: by which way.
[[nodiscard]] Scene finite_scene(const FiniteCell& cell, const SolverOptions& solver);

/// Motions "stretch", "turn", "twist", "fold", "jump", "through", "tear", "part". Throws
/// std::invalid_argument for another one.
[[nodiscard]] std::vector<Step> steps_of(const std::string& motion, const Problem& problem);

}  // namespace sunder::bench
