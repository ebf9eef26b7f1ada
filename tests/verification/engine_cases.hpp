// SPDX-License-Identifier: Apache-2.0
// Elasticity against published and independent numbers: the cases of the tests and of the page.
#pragma once

#include <string>
#include <vector>

#include "sunder/scene.hpp"
#include "support/body.hpp"

namespace sunder::test {

/// 192 distorted tetrahedra under a state of constant strain, 0 to 5 in Voigt order.
enum class PatchHeld { surface, three_nodes };
struct PatchErrors {
  double u = 0, stress = 0, residual = 0;
};
[[nodiscard]] PatchErrors patch_errors(int component, PatchHeld held);

/// Cantilever 10 x 1 x 1 with 10 n x n x n cubes cut into six tetrahedra each, E 5, nu 0, end
/// traction 1e-3 along y (1) or z (2): mean deflection of the end [mm].
inline constexpr double kTimoshenko = 0.8048;  // 0.8 of bending + 0.0048 of shear, k = 5/6
[[nodiscard]] double mean_end_deflection(Index cells, int axis);

/// Cook's membrane on cells x cells: vertical displacement [mm] at (48, 60) in plane strain (E 70,
/// nu 1/3, shear 6.25 per unit area) or at (48, 52) in plane stress (E 1, nu 1/3, total force 1).
enum class Plane { strain, stress };
[[nodiscard]] double cook_deflection(Plane plane, Index cells);
[[nodiscard]] inline double cook_published(Plane plane) {
  return plane == Plane::strain ? 32.27 : 23.96;
}

/// The same with what CalculiX needs to repeat it: displacement by both.
struct Twin {
  double ours = 0, calculix = 0;
};
[[nodiscard]] Twin cantilever_twin(Index cells);
[[nodiscard]] Twin cook_twin(Plane plane, Index cells);

/// The board of Table 1 after fractures along a crack: largest relative difference to CalculiX.
struct TwinErrors {
  double u = 0, stress = 0;
};
[[nodiscard]] TwinErrors board_twin(std::size_t fractures, Route route);

}  // namespace sunder::test
