// SPDX-License-Identifier: Apache-2.0
// Cracks as records: what a result file, a figure or a criterion needs to know about them.
// Geometry is the projection on the board's plane (method.md 4), undeformed, in mm.
#pragma once

#include <array>
#include <map>
#include <memory_resource>
#include <optional>
#include <string_view>
#include <vector>

#include "sunder/types.hpp"

namespace sunder {

enum class CrackKind { edge, internal };

struct CrackTip {
  Vec2 position;   ///< in-plane coordinates (along e1, e2)
  Vec2 direction;  ///< unit, forward
  bool ended = false;
};

/// Its lists come from a memory resource, so that cracks grow in frames without the allocator; a
/// copy's lists are its own, from the default resource.
struct Crack {
  Crack() = default;
  explicit Crack(std::pmr::memory_resource* lists)
      : tips(lists), path(lists), elements(lists), side(lists) {}

  int id = 0;
  CrackKind kind = CrackKind::edge;
  std::optional<Vec2> mouth;        ///< edge cracks
  std::pmr::vector<CrackTip> tips;  ///< one (edge) or two (internal)
  std::pmr::vector<Vec2> path;      ///< from mouth (or first tip) to the (second) tip
  double length = 0;                ///< of the path
  /// Destroyed elements that belong to this crack, in order.
  std::pmr::vector<Index> elements;
  /// Node -> +1 left of the path, -1 right (seen along d).
  std::pmr::map<Index, std::int8_t> side;
};

/// The terms of the stress intensity factor at one tip (Eq. 1-4), kept with each progression. k and
/// theta drive the tip: those of the formula or, with sif = "field", those that follow from K_I and
/// K_II. The terms of the other one are there for comparison.
struct SifTerms {
  int tip = 0;
  double k = 0, k_a = 0, k_b = 0, k_c = 0;  ///< [MPa sqrt(mm)]
  double theta = 0;                         ///< [deg] of growth from d, counter-clockwise
  double reach = 0;                         ///< r_e [mm] of the element (Eq. 1), 0 by toughness
  double sigma0 = 0;                        ///< remote stress s0 [MPa]
  double beta = 0;                          ///< [deg] between crack normal and n1
  double a = 0, b = 0;                      ///< crack length and chord [mm]
  /// K_I, K_II, K_III measured from the field [MPa sqrt(mm)]; none where it carries nothing.
  std::optional<double> k_1 = std::nullopt, k_2 = std::nullopt, k_3 = std::nullopt;
  /// Energy release rate by the field [N/mm], at any deformation.
  std::optional<double> j = std::nullopt;
  /// K [MPa sqrt(mm)] and theta [deg] by the formula and by the field, whichever drives the tip;
  /// none where nothing drives it by that one.
  std::optional<double> k_formula = std::nullopt, theta_formula = std::nullopt;
  std::optional<double> k_field = std::nullopt, theta_field = std::nullopt;
  /// What disturbs the field's K, words joined by +: "fixed", "material", "damage"; "notch": it
  /// was not measured at a notch of the mesh's shape; "strain": beyond small strain there is J in
  /// its place, and k_field = sqrt(J E'); empty: nothing. The text is static.
  std::string_view field_note = {};
  /// K_c [MPa sqrt(mm)] of the row's element; none: Eq. 1 let the tip pass.
  std::optional<double> toughness = std::nullopt;
  double advance = 0;  ///< of the tip in this event [mm]
  /// What the formula's direction v = K_a e_a + K_b d + K_c e_c is made of (method.md 8), in the
  /// plane: the tip's place [mm] and the unit vectors; d is its direction before the growth.
  Vec2 at = Vec2::Zero(), d = Vec2::Zero(), e_a = Vec2::Zero(), e_c = Vec2::Zero();
};

/// A face of a split crack that has opened: two triangles that were one. Nodes of the body as it
/// is, in the same order on both lips; the lip left of the path (seen from above) first, so turned
/// that its normal leaves its own tissue.
struct CrackFace {
  int crack = 0;
  std::array<Index, 3> left{}, right{};
};

/// A tip as it stands, whether it grows or rests (Simulation::tips): a row of tips.csv.
struct TipState {
  int crack = 0, tip = 0;
  bool ended = false;  ///< nothing drives it any more: no K
  Vec3 position;       ///< in space, at mid-thickness [mm]
  /// K >= 0 [MPa sqrt(mm)] by what drives the tips (fracture.sif), and theta [deg] of growth from
  /// the tip's direction, counter-clockwise; no theta where K is 0. None: that one has nothing to
  /// say here (field_note says why, if it is the field).
  std::optional<double> k = std::nullopt, theta = std::nullopt;
  /// With sif = "field".
  std::optional<double> k_1 = std::nullopt, k_2 = std::nullopt, k_3 = std::nullopt;
  std::optional<double> j = std::nullopt;  ///< likewise, as in SifTerms
  /// K_c [MPa sqrt(mm)] of the element into which it would grow; none: that has none, or the tip
  /// has ended.
  std::optional<double> toughness = std::nullopt;
  /// Where `toughness` is there: "plane stress" or "plane strain", whose E' makes K_c of G_c.
  std::string_view toughness_state = {};
  std::string_view field_note = {};  ///< as in SifTerms
};

}  // namespace sunder
