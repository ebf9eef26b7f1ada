// SPDX-License-Identifier: Apache-2.0
// What a fracture model is to the frame: it looks at the state and names the next event, and it
// keeps the cracks. A further model is a further implementation and one row
// in criterion.cpp.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "fracture/face.hpp"
#include "fracture/finding.hpp"
#include "sunder/backend.hpp"
#include "sunder/crack.hpp"
#include "sunder/report.hpp"

namespace sunder {

/// A pressing instrument as it acts now (method.md 7).
struct ActingPress {
  std::size_t instrument = 0;
  const Press* press = nullptr;
  Vec3 force;                    ///< times its ramp factor, N
  std::span<const Index> nodes;  ///< pressed nodes
};

/// A force on a node, N.
struct NodalForce {
  Index node;
  Vec3 force;
};

/// What a criterion may look at when it decides. Callbacks are cheap for single elements.
struct FractureState {
  const Problem& problem;
  std::span<const std::uint8_t> destroyed;  ///< per element
  StressSummary summary;
  std::function<Voigt(Index)> current_stress;
  /// Displacement of the intact body under the current expansion instruments alone, shape
  /// (3 * nodes); computed at the first call of a step, cached.
  std::function<std::span<const double>()> pristine_displacement;
  Vec3 expansion_resultant;  ///< forces and grip reactions of all expansion instruments, N
  std::span<const ActingPress> presses;
  /// Current displacement of some nodes [mm].
  std::function<void(std::span<const Index>, std::span<Vec3>)> displacement = {};
  /// What the instruments exert now, grips included.
  std::function<std::span<const NodalForce>()> forces = {};
  /// Live breakable elements at or over yield, by id; asked for in motion alone.
  std::function<std::span<const Worst>()> over = {};
  /// Patches of pooled volume as damage has split them; null: the problem's, if any.
  const fem::Pools* pools = nullptr;
};

/// One event: the elements that one update destroys. `cause`, `element`, `crack`, `ratio`, `sif`
/// are filled; step, event and load factor are the frame's. Empty: nothing breaks.
struct Decision {
  std::vector<DestroyedElement> elements;
  /// Elements that must not start a crack any more (they share a node with a crack's elements).
  std::vector<Index> excluded;
  /// To report, e.g. a closing push.
  std::vector<Finding> findings;
  /// Of cracks that split: the rows then say what has happened, and nothing is destroyed.
  fem::Change change;

  void clear() {
    change = {};
    elements.clear();
    excluded.clear();
    findings.clear();
  }
};

/// How the lips of split cracks lie to each other.
struct LipState {
  double overlap = 0;  ///< the largest, across the ideal path [mm]
  /// Where lips are to be kept apart: springs that come or go; no ties: they are at rest.
  fem::Change change;
  std::vector<Finding> findings;
};

/// At most one node of each surface.
struct PressedNodes {
  std::array<Index, 2> nodes{kNone, kNone};
  std::size_t count = 0;
  [[nodiscard]] std::span<const Index> list() const { return {nodes.data(), count}; }
};

/// What decisions go on from: the cracks and whatever a criterion keeps beside them.
class CriterionState {
 public:
  virtual ~CriterionState() = default;
};

class FractureCriterion {
 public:
  virtual ~FractureCriterion() = default;
  /// Names the next event, in place of what `decision` held, and records it in the cracks (the
  /// caller always carries it out).
  virtual void decide(const FractureState& state, Decision& decision) = 0;
  /// Elements that will break next if anything does, as far as can be told from a state in which
  /// nothing breaks; the likeliest of each crack tip first.
  virtual void next_in_line(const FractureState&, std::vector<Index>& next) { next.clear(); }
  /// All tips by crack and tip, with K as decide() would find it in this state; appended, as are
  /// the findings. Nothing changes.
  virtual void tips(const FractureState&, std::vector<TipState>&, std::vector<Finding>&) {}
  /// Preset cracks; called once, before anything else, when the problem has any. Elements come in
  /// crack order; returns what must be excluded as candidates.
  [[nodiscard]] virtual Decision preset() = 0;
  /// Nodes on which `press` acts, given what is destroyed (method.md 7), the lower (bottom
  /// surface) node first; none when its crack offers none (yet).
  [[nodiscard]] virtual PressedNodes pressed_nodes(
      const Press& press, std::span<const std::uint8_t> destroyed) const = 0;
  [[nodiscard]] virtual const std::vector<Crack>& cracks() const = 0;
  /// Of split cracks, in this state. The caller always carries the change out.
  [[nodiscard]] virtual LipState look_at_lips(const FractureState&) { return {}; }
  /// Faces that split cracks have opened, by crack.
  [[nodiscard]] virtual std::vector<CrackFace> faces() const { return {}; }
  /// Of all elements, where cracks split them; empty: as the mesh has them.
  [[nodiscard]] virtual std::span<const std::array<Index, 4>> corners() const { return {}; }
  /// Faces that a blade opens, where cracks split: of the body with all nodes at `places`, elements
  /// marked in `gone` left out.
  [[nodiscard]] virtual std::vector<fracture::PassedFace> passed(
      std::span<const std::array<Vec3, 3>> /*blade*/, std::span<const Vec3> /*places*/,
      std::span<const std::uint8_t> /*gone*/) const {
    return {};
  }
  /// Throws UsageError for faces that open() cannot take.
  virtual void check_opening(std::span<const fracture::PassedFace>,
                             std::span<const std::uint8_t> /*gone*/) {}
  /// Unknowns that the scene's grips hold from now on, ascending; at first all of them.
  virtual void hold(std::span<const Index> /*unknowns*/) {}
  /// Opens faces that check_opening() has passed, as cracks of their own: what decide() names for
  /// cracks that grow.
  virtual void open(std::span<const fracture::PassedFace>, const FractureState&, Decision&) {}
  /// The state of now; null: this criterion keeps none to go back to.
  [[nodiscard]] virtual std::shared_ptr<const CriterionState> state() const { return nullptr; }
  /// Goes back to one that state() gave, so that later decisions are bit by bit those of then.
  virtual void restore(const CriterionState&) {}
};

/// The criterion of problem.scene().fracture.model; never null (model none: never breaks anything).
[[nodiscard]] std::unique_ptr<FractureCriterion> make_criterion(const Problem& problem);

}  // namespace sunder
