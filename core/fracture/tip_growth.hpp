// SPDX-License-Identifier: Apache-2.0
// How a tip wants to grow: stress intensity and direction of one tip (method.md 5-8).
#pragma once

#include <optional>
#include <vector>

#include "fracture/board.hpp"
#include "fracture/criterion.hpp"
#include "fracture/remote_field.hpp"
#include "sunder/crack.hpp"

namespace sunder::fracture {

/// Pressure on the two faces of a crack, per unit of thickness [N/mm] (Eq. 4).
struct FacePressure {
  struct Push {
    double pressure;  ///< P of one instrument [N/mm]
    Vec2 at;          ///< mean of its pressed nodes
  };
  std::vector<Push> pushes;     ///< those with P > 0
  double upper = 0, lower = 0;  ///< Pu, Pl
  Vec2 upward = Vec2::UnitY();  ///< n_up
};

/// Pressure of the instruments that press on `crack`, in place of what `faces` held; a push that
/// closes it counts zero and is a finding.
void face_pressure(const Board& board, const Crack& crack, const FractureState& state,
                   std::vector<Finding>& findings, FacePressure& faces);

/// P-weighted mean distance from the tip to the pressed places [mm]; 0 without pressure. Eq. 4
/// takes at least h/2 of it as b'.
[[nodiscard]] double pressure_distance(const FacePressure& pressure, const Vec2& tip);

struct TipGrowth {
  SifTerms terms;    ///< reach is per element and left to the band
  double theta = 0;  ///< [rad]
  Vec2 direction;    ///< g, unit
};

/// The tip as it stands, without K.
[[nodiscard]] TipState tip_state(const Board& board, const Crack& crack, std::size_t tip);

/// What Eq. 2 to 4 say of one tip, with what its direction is made of; theta is left at 0.
[[nodiscard]] SifTerms formula_terms(const Board& board, const RemoteField& field,
                                     const Crack& crack, std::size_t tip,
                                     const FacePressure& pressure, const FractureState& state);

/// K and direction of one tip; none when nothing drives it (v = 0, method.md 8).
[[nodiscard]] std::optional<TipGrowth> tip_growth(const Board& board, const RemoteField& field,
                                                  const Crack& crack, std::size_t tip,
                                                  const FacePressure& pressure,
                                                  const FractureState& state);

}  // namespace sunder::fracture
