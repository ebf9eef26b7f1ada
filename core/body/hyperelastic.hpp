// SPDX-License-Identifier: Apache-2.0
// Energy, internal forces and tangents of a body at finite deformation (method.md "Finite
// deformation"): total Lagrangian, x = X + u. A destroyed element adds nothing, no share alpha.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "body/element.hpp"
#include "material/law.hpp"

namespace sunder::fem {

/// What a body consists of; it holds none of it.
struct HyperelasticBody {
  const Problem& problem;
  std::span<const Law* const> law_of_volume;     ///< of Mesh::volumes; may differ
  std::span<const std::uint8_t> destroyed = {};  ///< per element 1: destroyed; empty: none
  /// Patches of pooled volume in place of the problem's, where pieces have come off; null: those.
  std::shared_ptr<const Pools> split = {};

  [[nodiscard]] const Pools* pools() const { return split ? split.get() : problem.pools(); }
  [[nodiscard]] bool live(Index e) const { return destroyed.empty() || !destroyed[e]; }
  [[nodiscard]] const Law& law(Index e) const {
    return *law_of_volume[problem.mesh().volume_of[e]];
  }
};

/// Of each volume of a mesh, as the scene says; of one without elements: "linear".
[[nodiscard]] std::vector<const Law*> laws_of(const Problem& problem);
/// One law for all volumes of a mesh.
[[nodiscard]] std::vector<const Law*> one_law(const Problem& problem, const Law& law);

/// Sum of V W [N mm] at the displacement u (3 * nodes); infinite where a law knows no such state.
[[nodiscard]] double energy(const HyperelasticBody& body, std::span<const double> u);

/// f = d energy/du over all 3 * node_count entries, supports included (there f is minus the
/// support's force): sum of V P grad N. Element by element in their order. Returns the energy;
/// where that is infinite, f lacks the elements that are in no state of their law.
double internal_forces(const HyperelasticBody& body, std::span<const double> u,
                       std::span<double> f);

/// A stress by P and F: cauchy_stress or biot_stress (material/finite_stress.hpp).
using StressFunction = Voigt (*)(const Mat3& p, const Mat3& f);
/// Of live elements; others, and those in no state of their law, get 0. The linear law knows one
/// measure alone, P.
void element_stresses(const HyperelasticBody& body, std::span<const double> u,
                      StressFunction stress, std::span<Voigt> stresses);

/// exact; projected: by F the nearest positive semidefinite one; eased: between the two, nearer to
/// the exact one.
enum class Tangent { exact, eased, projected };
/// 12 x 12. Of an element whose volume is pooled the part that its own deformation decides, beside
/// patch_tangent (pooled_law.hpp), with the pressure of its patch from `pressure`, one a patch;
/// empty: that of u.
[[nodiscard]] ElementMatrix element_tangent(const HyperelasticBody& body, Index e,
                                            std::span<const double> u, Tangent kind,
                                            std::span<const double> pressure = {});

}  // namespace sunder::fem
