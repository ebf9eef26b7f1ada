// SPDX-License-Identifier: Apache-2.0
// Stress intensity factors of a crack's tip measured from the displacement field (method.md
// "Field K"): chooses the frame, the domain and the out-of-plane state for the interaction
// integral. Works on what lies within 6 h of the tip only.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "fracture/field_sif/interaction_integral.hpp"
#include "fracture/field_sif/notch.hpp"
#include "fracture/field_sif/tip_shift.hpp"
#include "fracture/tip_resistance.hpp"
#include "sunder/crack.hpp"

namespace sunder::fracture {

inline constexpr double kDomainRadius = 6.0;          ///< in h
inline constexpr double kSmallestDomainRadius = 3.0;  ///< in h, however near an obstacle is

/// The damaged body as it is now.
struct FieldView {
  std::span<const std::uint8_t> destroyed;  ///< per element
  /// Displacement of some nodes [mm].
  std::function<void(std::span<const Index>, std::span<Vec3>)> displacement;
  std::span<const NodalForce> forces;  ///< of pulling and pressing instruments
  bool small = false;                  ///< a field of small strain, whatever the body's laws
  /// Of all elements, where cracks have split some; empty: as the mesh has them.
  std::span<const std::array<Index, 4>> corners = {};
  /// The lips at the tip of a split crack: not known (K_I keeps its sign), free (where K_I is under
  /// 0 they overlap), or pressed on each other (K_I is 0).
  enum class Lips : std::uint8_t { unknown, free, pressed };
  Lips lips = Lips::unknown;
  /// By the direction in which the tip would grow; none: the same in all.
  std::optional<TipResistance> resistance = {};
  /// Patches of pooled volume as damage has split them; null: the problem's, if any.
  const fem::Pools* pools = nullptr;
};

/// What disturbs the field around a tip.
struct Disturbances {
  bool fixed = false;     ///< the domain reaches fixed nodes, whose reactions are left out
  bool material = false;  ///< it reaches another material
  bool damage = false;    ///< it reaches elements destroyed by something else
  bool notch = false;     ///< the crack is a notch too blunt for K, which is left out
  bool coarse = false;    ///< the mesh at its tip is too coarse; of a notch K is left out
  bool strain = false;    ///< it is strained or turned in itself beyond small strain: J, no K
  bool closed = false;    ///< the lips at the tip are: K_I is 0
  bool left_out = false;  ///< there is no K
};

struct FieldIntensity {
  IntensityFactors factors;  ///< beyond small strain modes, whose ratio tells a direction alone
  double j = 0;              ///< energy release rate [N/mm]
  TipFrame frame;            ///< in which they are meant
  double radius = 0;         ///< of the domain [mm]
  TipMaterial material;
  Disturbances disturbed;
  /// What disturbs them, as SifTerms::field_note.
  [[nodiscard]] std::string_view note() const;
};

class FieldIntensityMeter {
 public:
  FieldIntensityMeter(const Problem& problem, const Board& board);

  /// Mean over the front of one tip. `radius` [mm]: of the domain, chosen if left out.
  [[nodiscard]] FieldIntensity at(const Crack& crack, std::size_t tip, const FieldView& view,
                                  std::optional<double> radius = {});

  /// What at() takes the body for round this tip: its E' above all.
  [[nodiscard]] TipMaterial material_at(const Crack& crack, std::size_t tip, const FieldView& view);

  /// Along a straight front: at `stations` equidistant places from bottom to top, each the mean
  /// around it. Meant for blocks of several elements across.
  [[nodiscard]] std::vector<FieldIntensity> along_front(const Crack& crack, std::size_t tip,
                                                        const FieldView& view, int stations);

  /// The mesh's own crack that ends at this tip; null: elements were destroyed there.
  [[nodiscard]] const Notch* notch_of(const Crack& crack, std::size_t tip) const;

 private:
  /// What disturbs a domain: distances [mm] of the nearest element of another material and of the
  /// nearest element destroyed by something else than this crack.
  struct Surroundings {
    double other_material = std::numeric_limits<double>::infinity();
    double other_damage = std::numeric_limits<double>::infinity();
    [[nodiscard]] double nearest() const { return std::min(other_material, other_damage); }
  };
  [[nodiscard]] Surroundings look_around(const Crack& crack, const Vec2& tip, double radius,
                                         const FieldView& view);
  /// Radius of the domain with these surroundings [mm].
  [[nodiscard]] double chosen_radius(const Crack& crack, std::size_t tip,
                                     const Surroundings& around) const;
  void collect(const Vec2& tip, double radius, const FieldView& view,
               const std::optional<FrontStretch>& stretch = {});
  /// Whether a domain sees the board in plane stress.
  [[nodiscard]] bool thin(double radius) const;
  [[nodiscard]] TipMaterial tip_material(const TipDomain& domain) const;
  /// The stretch of the path within `length` behind the tip (its length along the path), the tip
  /// last. Holds until the next call.
  [[nodiscard]] std::span<const Vec2> path_tail(const Crack& crack, std::size_t tip, double length);
  [[nodiscard]] Vec2 mean_direction(const Crack& crack, std::size_t tip, double length);
  [[nodiscard]] std::optional<Vec2> fitted_direction(const Crack& crack, std::size_t tip,
                                                     double radius);
  [[nodiscard]] double clear_of_notch(const Crack& crack, std::size_t tip) const;
  [[nodiscard]] double wanted_radius(const Crack& crack, std::size_t tip) const;
  [[nodiscard]] bool at_root(const Crack& crack, std::size_t tip) const;
  [[nodiscard]] bool blunt(const Crack& crack, std::size_t tip) const;
  [[nodiscard]] FieldIntensity left_out(const Crack& crack, std::size_t tip,
                                        bool Disturbances::*why) const;
  void prepare_shifts();
  [[nodiscard]] Vec3 shift_of(const Crack& crack, std::size_t tip, const FieldView& view);
  static void close(FieldView::Lips lips, FieldIntensity& measured);
  void mend(const Crack& crack, std::size_t tip, const FieldView& view, FieldIntensity& measured);
  [[nodiscard]] FieldIntensity measure(const Crack& crack, std::size_t tip, const FieldView& view,
                                       double radius,
                                       const std::optional<FrontStretch>& stretch = {},
                                       IntensityFactors* shift = nullptr);

  const Problem& problem_;
  const Board& board_;
  int normal_axis_ = 2;  // coordinate axis nearest to the board's normal
  FreeSurface surface_;
  std::vector<Notch> notches_;              // presets whose faces are the mesh's own
  std::vector<Eigen::MatrixXd> per_shift_;  // per preset; empty: no mesh of its own, or none seen
  DomainBuilder builder_;
  PatchChanges patches_;
  std::vector<std::uint8_t> own_;  // shape (elements): of the crack being looked at
  // Of the tip in work, with room from the start: a frame allocates nothing.
  std::vector<Index> near_;
  TipDomain domain_;
  std::vector<Vec2> tail_;
  std::vector<NodalForce> turned_forces_;
  std::vector<Vec3> displacement_;
};

}  // namespace sunder::fracture
