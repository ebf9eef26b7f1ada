// SPDX-License-Identifier: Apache-2.0
// A body whose nodes have parted, seen as a mesh of its own: new nodes have unknowns like any
// other, so that a base takes them over. Ids of nodes and elements, and the numbers of unknowns,
// are those of the body: offsets have the places of the new nodes' unknowns. Events that follow are
// told in its terms, forces and displacements are carried over.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <vector>

#include "body/damaged_body.hpp"
#include "body/offsets.hpp"

namespace sunder::fem {

/// The body as a mesh of its own, its new nodes with unknowns like any other's. Elements that have
/// another form than by their corners are as the mesh has them.
[[nodiscard]] std::shared_ptr<const Problem> parted_problem(const DamagedBody& body);
/// The same of `whole`, which is the body's problem but for what is gripped.
[[nodiscard]] std::shared_ptr<const Problem> parted_problem(const DamagedBody& body,
                                                            const Problem& whole);

/// Whether new nodes of a body can be nodes of a mesh: each has an element, none is tied to its
/// parent or kept to one that a grip moves, no element has another form than by its corners, and
/// lips are not to be kept apart.
[[nodiscard]] bool can_be_parted(const DamagedBody& body);

class PartedBody {
 public:
  /// can_be_parted(body) must hold.
  explicit PartedBody(const DamagedBody& body);

  /// Nothing has happened to it yet but that elements are destroyed and grips have taken hold.
  [[nodiscard]] const DamagedBody& body() const { return body_; }
  /// The event after the last one, in the terms of this body.
  [[nodiscard]] Change translate(const Event& event);

  /// Forces on the body's unknowns and offsets become those on this one's.
  void take_forces(Eigen::VectorXd& forces) const;
  /// Displacements of this one's unknowns and offsets become those of the body's.
  void give_displacement(Eigen::VectorXd& u) const;

  /// What translating has left, to go back to.
  struct State {
    std::size_t kept = 0;
    std::map<Index, std::array<Index, 4>> corners;
  };
  [[nodiscard]] State state() const { return {kept_.size(), corners_}; }
  void restore(const State& state) {
    kept_.resize(state.kept);
    corners_ = state.corners;
  }

 private:
  /// What a new node's displacement is measured by: `of`, in the body; `by`, here.
  struct Kept {
    Index of = 0, by = kNone;  ///< nodes; by: none, it has unknowns of its own
    Axes axes;
  };
  [[nodiscard]] const std::array<Index, 4>& corners(Index element) const;
  void add(const NewNode& node, Index by);
  template <class Act>
  void for_unknowns(Act&& act) const;

  const Problem& whole_;
  DamagedBody body_;
  std::vector<Kept> kept_;                         // of each new node
  std::map<Index, std::array<Index, 4>> corners_;  // that elements have got since
};

}  // namespace sunder::fem
