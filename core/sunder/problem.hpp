// SPDX-License-Identifier: Apache-2.0
// A checked scene, turned into numbers: shapes, elasticity, dofs, resolved selections. Immutable;
// shared by the simulation and its backend.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sunder/scene.hpp"
#include "sunder/small_strain.hpp"

namespace sunder {

class Interfaces;
struct FractureModelRow;

namespace fem {
struct Bodies;
class Pools;
}  // namespace fem

/// Constant-strain tetrahedron: gradients of the four shape functions [1/mm] and volume [mm^3].
struct TetShape {
  Eigen::Matrix<double, 3, 4> gradient;
  double volume = 0;
};

/// An instrument's resolved nodes (empty for Press: they depend on the crack's state).
struct InstrumentNodes {
  std::vector<Index> nodes;  ///< ascending
};

/// A node that comes where another lies: on the axes that it has not it is held, or gripped, as the
/// other is.
struct NodeThatParts {
  Index parent = 0;
  Axes axes;
};

/// Nodes and elements of a body, ascending. Elements have their corners among the nodes.
struct PartOfBody {
  std::vector<Index> nodes, elements;
};

class Problem {
 public:
  /// Checks the scene strictly and resolves all names and selections; turns elements of negative
  /// volume (mesh()). Throws InputError.
  explicit Problem(Scene scene);
  /// A part of a body, with unknowns, grips and anchors of its own numbering: what computes its
  /// fields. Its stiffness lacks that of the rest.
  Problem(const Problem& whole, const PartOfBody& part);
  /// The same body whose elements have other corners, at nodes that come after its own: its
  /// unknowns keep their numbers, those of the new nodes follow by node and axis. What is selected
  /// is not.
  Problem(const Problem& whole, std::vector<std::array<Index, 4>> corners,
          std::span<const NodeThatParts> nodes);
  /// The same body with these unknowns gripped, in place of its own; kept ascending. What is
  /// selected is not.
  Problem(const Problem& whole, std::span<const Index> gripped);
  Problem(const Problem&) = delete;  // holds pointers into its own scene
  Problem& operator=(const Problem&) = delete;

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const Mesh& mesh() const { return scene_.mesh; }
  [[nodiscard]] Index node_count() const { return mesh().node_count(); }
  [[nodiscard]] Index tet_count() const { return mesh().tet_count(); }

  /// Shape of element e.
  [[nodiscard]] const TetShape& shape(Index e) const { return shapes_[e]; }
  /// Material of element e.
  [[nodiscard]] const Material& material(Index e) const {
    return *material_of_volume_[mesh().volume_of[e]];
  }
  /// What the law of element e is at small strain.
  [[nodiscard]] const SmallStrain& small_strain(Index e) const {
    if (fibrous()) return small_strain_of_element_[e];
    return small_strain_of_volume_[mesh().volume_of[e]];
  }
  /// Whether any of its elements has fibres with a stiffness; small_strain(e) has those of e.
  [[nodiscard]] bool fibrous() const { return fibres_ != nullptr; }
  /// Most families that an element has, 0 to 2.
  [[nodiscard]] int fibre_families() const;
  /// Whether any has fibres without one, which guide cracks.
  [[nodiscard]] bool guides_cracks() const { return guides_ != nullptr; }
  /// Unit vector of a family in the undeformed element; 0 where it has none.
  [[nodiscard]] Vec3 fibre_direction(Index e, int family) const;
  /// Patches of the elements that pool their volume (body/pools.hpp); null where none does.
  [[nodiscard]] const fem::Pools* pools() const { return pools_.get(); }
  /// Layers of the scene's interfaces (interfaces.hpp); null where it has none.
  [[nodiscard]] const Interfaces* interfaces() const { return interfaces_.get(); }
  /// Whether an element is one of them.
  [[nodiscard]] bool in_interface(Index e) const;
  /// Whether a law of its elements is one of finite deformation.
  [[nodiscard]] bool finite() const { return finite_; }
  /// Whether its steps are steps of time.
  [[nodiscard]] bool moves() const { return scene_.dynamics.has_value(); }
  /// As a scene names it; of several ", " between, in the order of MaterialLaw.
  [[nodiscard]] std::string law() const;
  /// Yield stress of element e [MPa]; 0: no stress breaks it.
  [[nodiscard]] double yield(Index e) const { return material(e).yield.value_or(0.0); }
  /// Of a breakable element: the measure of a stress over its strength, which may be another along
  /// fibres than across (method.md "Fibres").
  [[nodiscard]] double yield_ratio(Index e, const Voigt& stress, YieldMeasure measure) const;
  /// By strength.
  [[nodiscard]] bool breakable(Index e) const { return material(e).yield.has_value(); }
  /// By strength, or by a crack that grows where the material has a toughness.
  [[nodiscard]] bool destructible(Index e) const {
    return breakable(e) || (reads_toughness_ && material(e).tough());
  }

  /// Number of unknowns n: dofs not held by a support. Gripped dofs are unknowns. Nodes that no
  /// element uses, and in statics those of a body that nothing holds or drives, have none and stay
  /// in place.
  [[nodiscard]] Index dof_count() const { return dof_count_; }
  /// Unknown of (node, axis), or kNone where a support holds it or the node is left out.
  [[nodiscard]] Index dof(Index node, int axis) const { return dof_[3 * node + axis]; }
  /// Same, flat: index 3 * node + axis.
  [[nodiscard]] std::span<const Index> dofs() const { return dof_; }
  /// Unknowns with prescribed displacement, ascending, of all grips.
  [[nodiscard]] std::span<const Index> gripped_dofs() const { return gripped_dofs_; }
  /// Spring [N/mm] added to K0 at the gripped dofs of a body that only grips hold; 0 when every
  /// body has supports of its own. It leaves the solution exact: u is prescribed there, so the
  /// spring's force is known and is taken off the reaction.
  [[nodiscard]] double anchor_stiffness() const { return anchor_stiffness_; }
  [[nodiscard]] std::span<const Index> anchored_dofs() const { return anchored_dofs_; }
  /// The last gripped dofs are those of nodes that have parted: for each of them the place in
  /// gripped_dofs() of the one whose displacement it has.
  [[nodiscard]] std::span<const Index> parted_grips() const { return parted_grips_; }

  [[nodiscard]] const std::vector<InstrumentNodes>& instrument_nodes() const {
    return instrument_nodes_;
  }
  /// Elements of each preset crack, ascending.
  [[nodiscard]] const std::vector<std::vector<Index>>& crack_elements() const {
    return crack_elements_;
  }
  /// Elements of each scripted removal, ascending.
  [[nodiscard]] const std::vector<std::vector<Index>>& removal_elements() const {
    return removal_elements_;
  }
  /// Findings that are no errors.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void resolve_materials();
  void build_shapes();
  void make_pools();
  void lay_fibres();
  void lay_guides();
  void note_fibres();
  void take_fibres(const Problem& whole, std::span<const Index> elements);
  [[nodiscard]] std::vector<std::uint8_t> held_axes() const;
  void select_instrument_nodes();
  void leave_out_what_nothing_holds(const fem::Bodies& bodies, std::vector<std::uint8_t>& held);
  void latch_what_hangs(const fem::Bodies& bodies, std::vector<std::uint8_t>& held);
  void number_unknowns(std::span<const std::uint8_t> held);
  void resolve_grips();
  void resolve_pulls();
  void resolve_presses();
  void resolve_elements();
  void check_options();
  void check_crack(const FractureOptions& f, const FractureModelRow& model);
  void check_motion();
  void check_density(const std::string& name, const Material& material);
  void check_held_bodies(const fem::Bodies& bodies);
  void note_odd_mesh();
  void note_no_board();
  void note_toughness();

  Scene scene_;
  std::vector<TetShape> shapes_;
  std::vector<const Material*> material_of_volume_;
  std::vector<SmallStrain> small_strain_of_volume_;
  std::shared_ptr<const fem::Pools> pools_;
  std::shared_ptr<const Interfaces> interfaces_;
  std::shared_ptr<const std::vector<ElementFibres>> fibres_;  // of elements; null: none has any
  std::vector<SmallStrain> small_strain_of_element_;          // where fibres_ is there
  std::shared_ptr<const std::vector<Vec3>> guides_;           // likewise; null: none
  bool finite_ = false;
  bool reads_toughness_ = false;  // the fracture model grows cracks
  std::vector<Index> dof_;
  Index dof_count_ = 0;
  std::vector<Index> gripped_dofs_, anchored_dofs_, parted_grips_;
  double anchor_stiffness_ = 0;
  std::vector<InstrumentNodes> instrument_nodes_;
  std::vector<std::vector<Index>> crack_elements_, removal_elements_;
  std::vector<std::string> warnings_;
};

}  // namespace sunder
