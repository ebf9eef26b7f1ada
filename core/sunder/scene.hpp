// SPDX-License-Identifier: Apache-2.0
// A scene as the user states it: mesh, materials, supports, instruments, cracks, scripts, options.
// Plain data; `Problem` (problem.hpp) checks it and turns it into numbers. Units: mm, N, MPa.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sunder/mesh.hpp"

namespace sunder {

/// linear: theory of small strains, as in the paper; the others at any deformation (method.md
/// "Finite deformation"). A body whose materials are not all linear is computed by the latter.
enum class MaterialLaw { linear, corotated, neo_hookean, saint_venant_kirchhoff };

/// Whether an element has its change of volume to itself or shares it with some others of its
/// material, so that nearly incompressible tissue does not lock (method.md "Pooled volume").
enum class MaterialVolume { element, pooled };

/// A cell field of the mesh file (Mesh::fields).
struct FieldName {
  std::string name;
};
/// Round an axis: at right angles to it and to the way from it to the element's centroid.
struct AroundAxis {
  Vec3 point, axis;
};

/// Along the piece of a polyline that is nearest to the element's centroid.
struct AlongCurve {
  std::vector<Vec3> points;  ///< at least two [mm]
};
/// Along a named surface: a direction less its part across the triangle whose middle is nearest to
/// the element's centroid.
struct AlongSurface {
  std::string surface;
  Vec3 direction;
};

/// A family of fibres (method.md "Fibres").
struct Fibres {
  std::variant<Vec3, AroundAxis, FieldName, AlongCurve, AlongSurface> direction = Vec3::Zero();
  /// Laws of finite deformation: k1 [MPa], > 0; k2, >= 0; kappa in [0, 1/3].
  std::optional<double> k1 = {}, k2 = {};
  double dispersion = 0;
  /// Law "linear": E along [MPa], the contraction across for an extension along, G of shear along
  /// [MPa]. The material's own young and poisson hold across.
  std::optional<double> young_along = {}, poisson_along = {}, shear_along = {};
  /// Strength across [MPa], > 0, where the material's yield holds along; none: as along.
  std::optional<double> yield_across = {};
  /// In place of all of the above but the direction: fibres without a stiffness of their own, which
  /// guide cracks (method.md "Toughness by direction"). K_c [MPa sqrt(mm)] or G_c [N/mm] of cracks
  /// across them, > 0, where the material's toughness or energy holds along.
  std::optional<double> toughness_across = {}, energy_across = {};
  [[nodiscard]] bool guide_cracks() const { return toughness_across || energy_across; }
};

/// Isotropic elasticity but for its fibres; without yield nothing ruptures in it, without yield and
/// toughness it is unbreakable (method.md "Elasticity").
struct Material {
  double young = 0;             ///< E [MPa] at small strain, finite and > 0
  double poisson = 0;           ///< nu in (-1, 0.5), likewise
  std::optional<double> yield;  ///< yield stress [MPa], finite and > 0
  MaterialLaw law = MaterialLaw::linear;
  /// [t/mm^3], water 1e-9, finite and > 0; needed in motion and under gravity.
  std::optional<double> density = {};
  /// What lets a crack of model "B" grow in it (method.md "Toughness"): K_c [MPa sqrt(mm)] or G_c
  /// [N/mm], finite and > 0, at most one of them; none: Eq. 1's reach, by yield.
  std::optional<double> toughness = {}, energy = {};
  MaterialVolume volume = MaterialVolume::element;
  std::vector<Fibres> fibres = {};  ///< families, at most two
  [[nodiscard]] bool tough() const { return toughness || energy; }
};

struct Box {
  Vec3 min, max;  ///< closed
};
struct Ball {
  Vec3 center;
  double radius = 0;
};
struct SurfaceName {
  std::string name;
};
struct VolumeName {
  std::string name;
};

/// Nodes by box, ball, named surface, or ids.
using NodeSelection = std::variant<std::vector<Index>, Box, Ball, SurfaceName>;
/// Elements by ids, named volume, or box (of centroids).
using ElementSelection = std::variant<std::vector<Index>, VolumeName, Box>;

struct Support {
  NodeSelection nodes;
  Axes axes;  ///< held axes
};

/// An instrument acts with clamp((t - begin)/(end - begin), 0, 1); a step at `begin` if equal.
struct Ramp {
  double begin = 0, end = 0;
  [[nodiscard]] double factor(double time) const;
};

/// Pulls: a total force in equal parts on its nodes ("expansion", f1).
struct Pull {
  NodeSelection nodes;
  Vec3 force;
};
/// Grips: a prescribed displacement of the held axes of its nodes (expansion by a stiff tool).
/// A grip holds its nodes from the start; the ramp scales the displacement and the turn.
struct Grip {
  NodeSelection nodes;
  Vec3 displacement;
  Axes axes;
  /// All its nodes move as one solid, which may turn; it holds all axes.
  bool rigid = false;
  Vec3 turn = Vec3::Zero();  ///< rotation vector about the nodes' centroid [deg]
};
enum class CrackSide { upper, lower };
/// Presses on one face of a crack at the nodes nearest to `at` ("pressure", f2; method.md 7).
struct Press {
  Vec3 at;
  CrackSide side = CrackSide::upper;
  int crack = 0;
  Vec3 force;
};

struct Instrument {
  std::string name;
  std::variant<Pull, Grip, Press> action;
  std::optional<Ramp> ramp;  ///< none: fully from the start
  [[nodiscard]] double factor(double time) const { return ramp ? ramp->factor(time) : 1.0; }
};

/// A preset crack: its elements are destroyed from the start. Edge crack: mouth and one tip;
/// internal crack: no mouth and two tips.
struct PresetCrack {
  ElementSelection elements;
  std::optional<Vec3> mouth;
  std::vector<Vec3> tips;
};

/// A surface between two volumes that parts by a law of its own (method.md "Interfaces"): traction
/// grows with the opening up to the strength, and the area under it is the energy.
struct Interface {
  std::array<std::string, 2> between;  ///< names of volumes, which must share faces
  double strength = 0;                 ///< in tension [MPa], finite and > 0
  double energy = 0;                   ///< in tension [N/mm], finite and > 0
  double shear_ratio = 1;              ///< of the strength in shear to it, finite and > 0
};

/// Elements removed before the first solve of a step (a cautery, a cut).
struct ScriptedRemoval {
  int step = 0;
  ElementSelection elements;
};

/// Motion with lumped masses (method.md "Motion"): one step of a run is one of time.
struct Dynamics {
  double time_step = 0;  ///< [s], finite and > 0
  /// Force per mass and velocity [1/s]; stress per small-strain stiffness and strain rate [s].
  double mass_damping = 0, stiffness_damping = 0;
  int max_iterations = 0;  ///< of a step; 0: as many as the tolerance takes
  /// Whether the force of a grip includes what accelerates its own nodes.
  bool felt_inertia = false;
};

enum class FractureModel { none, a, b, p };
/// At finite deformation: the true stress, or the nominal one in the material's frame.
enum class StressMeasure { cauchy, biot };
enum class YieldMeasure { max_shear, tresca, principal };  ///< principal: model P's own
/// present: the line mean of the current, damaged field (method.md 5).
enum class RemoteStress { line, tip, present };
enum class CrackLength { path, tool };
enum class CrackBirth { element, through };
enum class SifSource { formula, field };
/// What a crack of model B leaves: destroyed elements, or a surface of faces that have opened
/// (method.md "Split cracks").
enum class CrackWay { destroyed, split };

struct FractureOptions {
  FractureModel model = FractureModel::none;
  double alpha = 1e-6;  ///< remaining share of a destroyed element's stiffness, in (0, 1)
  YieldMeasure yield_measure = YieldMeasure::max_shear;
  RemoteStress sigma0 = RemoteStress::line;
  CrackLength crack_length = CrackLength::path;
  /// What an MSS rupture that starts a crack takes with it: nothing, or what hangs beside the
  /// element through the thickness (method.md 4).
  CrackBirth birth = CrackBirth::element;
  SifSource sif = SifSource::formula;
  CrackWay crack = CrackWay::destroyed;
  int max_new_nodes = 0;   ///< with split: how many may come; 0: as many as the mesh has, or 1,000
  bool contact = false;    ///< with split: keeps the lips of cracks apart
  int max_events = 10000;  ///< of one step
  std::optional<Vec3> plane_normal;  ///< overrides the third axis of the bounding box
  double averaging = 0;  ///< radius of the mean that strength is judged by [mm], 0: by element
  StressMeasure stress =
      StressMeasure::cauchy;  ///< that criteria and results mean, laws but linear
};

enum class Route { automatic, inverse, condensed, factor, cg };
enum class Update { automatic, eager, deferred };
enum class Precision { automatic, fp32, fp64 };

struct SolverOptions {
  std::string backend = "auto";  ///< "auto" or a backend's name
  int device = kNone;            ///< index among the backend's devices, kNone: it chooses
  Route route = Route::automatic;
  Update update = Update::automatic;
  Precision precision = Precision::automatic;
  double tolerance = 1e-4;  ///< promised relative stress error of every frame
  /// Prepares in quiet frames what the fractures next in line will need; no result changes.
  bool prepare = true;
  /// A step ends after the event that found so much of it passed [ms], finite and >= 0; 0: none.
  double max_ms = 0;
};

struct OutputOptions {
  bool displacement = true;
  bool stress = true;
};

struct Scene {
  std::string title;
  std::string source;  ///< where it came from (a file name); begins messages
  Mesh mesh;
  std::map<std::string, Material> materials;  ///< by volume name
  std::vector<Support> supports;
  std::vector<Instrument> instruments;
  std::vector<PresetCrack> cracks;
  std::vector<Interface> interfaces;
  std::vector<ScriptedRemoval> removals;
  FractureOptions fracture;
  SolverOptions solver;
  int steps = 1;
  OutputOptions output;
  Vec3 gravity = Vec3::Zero();       ///< [mm/s^2]
  std::optional<Dynamics> dynamics;  ///< none: statics
  /// A host may grasp and remove at any time (Simulation), also where nothing breaks or is removed
  /// by the scene.
  bool live = false;
};

}  // namespace sunder
