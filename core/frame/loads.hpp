// SPDX-License-Identifier: Apache-2.0
// The instruments as they act at a scene time: nodal forces, prescribed displacements.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "body/node_elements.hpp"
#include "fracture/criterion.hpp"
#include "frame/tool.hpp"
#include "frame/weight.hpp"
#include "sunder/backend.hpp"

namespace sunder {

class Loads {
 public:
  explicit Loads(const Problem& problem);

  /// Instruments at scene time t, in statics with the body's weight. Pressing instruments choose
  /// their nodes when they start to act, and again when such a node has lost its last live element
  /// (method.md 7). Adds to `findings`.
  void update(double time, const FractureCriterion& criterion,
              std::span<const std::uint8_t> destroyed, std::vector<Finding>& findings);

  /// Loads that all those of the instruments, of a host's grips and pushes and of the weight are
  /// sums of, but for presses, on the unknowns of all of these: as many as a solver remembers at
  /// most, shifts before turns. The last one is the scene's own at a time, whatever a host drives.
  [[nodiscard]] std::vector<Load> span(double time);

  /// Instrument i has this force or displacement from the next update on, whatever the scene says.
  void drive(std::size_t instrument, const Vec3& value) { driven_[instrument] = value; }
  /// A rigid grip has turned so far from the next update on [deg].
  void turn(std::size_t instrument, const Vec3& rotation) { turned_[instrument] = rotation; }
  /// Force or displacement of instrument i at a scene time, its turn left out.
  [[nodiscard]] Vec3 value(std::size_t instrument, double time) const;

  /// What a host and cracks have made of the instruments, to go back to; update() follows.
  struct State {
    std::vector<std::vector<Index>> pressed;
    std::vector<std::optional<Vec3>> driven, turned;
    std::vector<std::uint8_t> let_go;
    std::vector<Tool> tools;
    int next_tool = 0;
  };
  [[nodiscard]] State state() const {
    return {pressed_, driven_, turned_, let_go_, tools_, next_tool_};
  }
  void restore(const State& state);

  /// What a host holds and pushes the body by, in the order in which it came: the displacements of
  /// its grips follow those of the scene's in a load. Returns the id that it gets.
  int take(Tool tool);
  void drop(int id);
  /// A push acts on other nodes, with another force.
  void move(int id, std::span<const Index> nodes, const Vec3& force);
  [[nodiscard]] const std::vector<Tool>& tools() const { return tools_; }
  /// Null: there is none of this id.
  [[nodiscard]] Tool* tool(int id);
  /// A solution of the last update's load has been found: what grips exert is told by it.
  void solved();
  /// Id of the next one.
  [[nodiscard]] int next_tool() const { return next_tool_; }
  /// Nodes that grips of a host hold.
  [[nodiscard]] std::vector<Index> held_nodes() const;
  /// A grip of the scene prescribes nothing from the next update on. Returns its unknowns.
  std::vector<Index> let_go(std::size_t instrument);
  [[nodiscard]] bool has_let_go(std::size_t instrument) const { return let_go_[instrument] != 0; }
  /// Unknowns that the scene's grips hold, as gripped().
  [[nodiscard]] std::span<const Index> held_unknowns() const { return held_unknowns_; }

  [[nodiscard]] const Load& load() const { return all_; }
  /// Without the pressing instruments (the pristine field's load).
  [[nodiscard]] const Load& expansion() const { return expansion_; }
  /// Pressing instruments that act now.
  [[nodiscard]] std::span<const ActingPress> presses() const { return acting_; }
  /// Nodes on which instrument i acts now.
  [[nodiscard]] std::span<const Index> nodes(std::size_t instrument) const;
  /// Total force of instrument i now; zero for grips.
  [[nodiscard]] const Vec3& force(std::size_t instrument) const { return forces_[instrument]; }
  /// Of these, with the weight there, what acts on axes that supports hold.
  [[nodiscard]] Vec3 force_on_supports() const;
  /// Of the body on gripped dof g of the scene, in statics: a part of the grip's reaction.
  [[nodiscard]] double weight_on_grip(std::size_t g) const;
  /// Per gripped dof of the scene that has not been let go: the instrument that grips it, and the
  /// axis.
  struct Gripped {
    std::size_t instrument;
    Index node;
    int axis;
    Vec3 arm = Vec3::Zero();  ///< of a rigid grip: of the node from the nodes' centroid [mm]
  };
  [[nodiscard]] const std::vector<Gripped>& gripped() const { return gripped_; }

 private:
  void choose_pressed_nodes(std::size_t instrument, const FractureCriterion& criterion,
                            std::span<const std::uint8_t> destroyed,
                            std::vector<Finding>& findings);
  void reserve();
  void take_turns(double time);
  void expand(double time);
  [[nodiscard]] std::vector<Load> span_on(const Load& first) const;
  void add(std::span<const Index> nodes, const Vec3& force);
  [[nodiscard]] Vec3 on_supports(std::span<const Index> nodes, const Vec3& force) const;
  void tools_changed();
  void find_gripped();
  void sum_into(Load& load);

  /// A share of an instrument's force; those of a dof are summed in the order they came in.
  struct Share {
    Index dof;
    int order;
    double force;
  };

  const Problem& problem_;
  std::optional<NodeElements> elements_of_node_;  // only where something presses
  std::optional<Weight> weight_;                  // only in statics under gravity
  std::vector<std::vector<Index>> pressed_;       // per instrument
  std::vector<Gripped> gripped_;
  std::vector<Index> held_unknowns_;  // as gripped_
  std::vector<std::uint8_t> let_go_;  // per instrument
  std::vector<std::optional<Vec3>> driven_, turned_;
  std::vector<Tool> tools_;
  int next_tool_ = 0;
  std::vector<Mat3> turn_;  // per instrument, of the update in work: R - I
  std::vector<Vec3> forces_;
  std::vector<ActingPress> acting_;
  Load all_, expansion_;
  std::vector<Share> shares_, sorted_;  // of the update in work
};

}  // namespace sunder
