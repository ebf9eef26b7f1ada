// SPDX-License-Identifier: Apache-2.0
// An event as a change of elements (method.md "Changes"): some leave, some come, and nodes may come
// with them. Ids of the file's nodes and elements never change; what comes is appended. Destroying
// is the change in which none comes; the reverse of a change is a change too.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "body/damaged_pools.hpp"
#include "sunder/problem.hpp"

namespace sunder::fem {

/// An element as it stands in a body.
struct Form {
  std::array<Index, 4> corners{};  ///< nodes of the mesh and, with ids after theirs, new ones
  TetShape shape;
  SmallStrain law;   ///< own_law() (element.hpp)
  double share = 1;  ///< of its stiffness: alpha once it has left, 0 before it first came
};
/// An element that comes takes this form, whatever form it had.
struct Coming {
  Index element = 0;  ///< one that is there, or the first id beyond
  Form form;
};
/// Its displacement is that of its parent, a node of the mesh, plus an offset of its own on some
/// axes: the new unknowns. On the other axes it keeps to its parent, whatever holds that. Where
/// stiffness differs the softer elements should take the new node (method.md 16).
struct NewNode {
  Index parent = 0;
  Axes axes;
  double tie = 0;  ///< what holds both together [N/mm], on each of those axes
  /// A spring along one direction beside it: unit vector times the root of its stiffness
  /// [(N/mm)^1/2]; what keeps closed lips apart.
  Vec3 spring = Vec3::Zero();
};
/// Holds a new node to its parent where faces that have opened leave a piece loose: in statics it
/// would have no place. A share alpha of the stiffness, as a destroyed element leaves. Or
/// keeps both apart where lips have closed, along one direction.
struct Tie {
  Index node = 0;              ///< a new one
  double stiffness = 0;        ///< from now on [N/mm], as NewNode::tie
  Vec3 spring = Vec3::Zero();  ///< from now on, as NewNode::spring
};
/// A change that somebody else holds.
struct Event {
  std::span<const Index> leave{};
  std::span<const Coming> come{};
  std::span<const NewNode> nodes{};
  std::span<const Tie> ties{};
  bool held = false;  ///< its maker has seen that it leaves nothing without a hold
  /// Unknowns that a grip takes hold of, and others that one lets go. Such an event changes no
  /// element.
  std::span<const Index> grasp{}, release{};
  [[nodiscard]] bool of_grips() const { return !grasp.empty() || !release.empty(); }
};
/// Elements in `leave` keep a share alpha of their stiffness.
struct Change {
  std::vector<Index> leave;
  std::vector<Coming> come;
  std::vector<NewNode> nodes;
  std::vector<Tie> ties = {};
  bool held = false;
  std::vector<Index> grasp = {}, release = {};
  operator Event() const { return {leave, come, nodes, ties, held, grasp, release}; }
};

/// The record of what has happened to a body, change by change.
class Damage {
 public:
  /// For so many events that leave so many elements: they allocate nothing.
  void reserve(std::size_t elements, std::size_t events);
  void add(const Event& event);
  /// Drops the last change.
  void take_back();
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] Event operator[](std::size_t i) const;
  [[nodiscard]] Event last() const { return (*this)[size() - 1]; }

 private:
  struct End {
    std::uint32_t leave = 0, come = 0, nodes = 0, ties = 0, grasp = 0, release = 0;
  };
  std::vector<End> ends_;  // of each event in the lists
  std::vector<Index> leave_;
  std::vector<Coming> come_;
  std::vector<NewNode> nodes_;
  std::vector<Tie> ties_;
  std::vector<Index> grasp_, release_;
};

/// Every element's form after some changes.
class Forms {
 public:
  /// As the mesh has them. The problem must outlive it.
  explicit Forms(const Problem& problem);
  /// The nodes of an event, before its elements are asked about or followed.
  void add(std::span<const NewNode> nodes);
  /// The elements of an event and its ties. Allocates nothing where elements of the mesh's form
  /// leave and nothing pools its volume. `more`: events follow at once, and pools() only after
  /// them.
  void follow(const Event& event, bool more = false);

  [[nodiscard]] Index element_count() const;
  [[nodiscard]] Index node_count() const;
  [[nodiscard]] Form of(Index element) const;
  /// Of its stiffness; 0 for one that never came.
  [[nodiscard]] double share(Index element) const;
  /// Elements that have taken a form by coming, by id; the others are as the mesh has them, but
  /// that some have left.
  [[nodiscard]] const std::map<Index, Form>& came() const { return came_; }
  /// 1 for elements of the mesh that have left: no more than alpha of their stiffness is there.
  [[nodiscard]] std::span<const std::uint8_t> destroyed() const { return destroyed_; }
  /// In the order of their ids, which begin after the mesh's.
  [[nodiscard]] std::span<const NewNode> new_nodes() const { return nodes_; }
  /// Unknowns whose displacement grips prescribe: those of the problem that are still held, then
  /// others in the order in which they were grasped.
  [[nodiscard]] std::span<const Index> gripped() const { return gripped_; }
  /// The first of them: those of the problem that have not been let go.
  [[nodiscard]] std::span<const Index> own_gripped() const {
    return std::span(gripped_).first(own_gripped_);
  }
  /// Of an element of the mesh, as it stands.
  [[nodiscard]] const std::array<Index, 4>& corners(Index element) const;
  /// The corners' nodes of the mesh: a new node's is its parent.
  [[nodiscard]] std::array<Index, 4> parents(const std::array<Index, 4>& corners) const;
  /// Patches of pooled volume as this body has them; null: none.
  [[nodiscard]] const Pools* pools() const { return pools_.of(*problem_); }
  [[nodiscard]] const DamagedPools& damaged_pools() const { return pools_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }

 private:
  void split_pools();

  const Problem* problem_;
  std::vector<std::uint8_t> destroyed_;  // per element of the mesh
  std::map<Index, Form> came_;
  DamagedPools pools_;
  std::vector<Index> changed_;  // by events that pools_ has not followed
  std::vector<NewNode> nodes_;
  std::vector<Index> gripped_;
  std::size_t own_gripped_;
};

/// An element's form in the mesh.
[[nodiscard]] Form form_in_mesh(const Problem& problem, Index element);
/// Same law and shape over the same nodes of the mesh: the stiffness differs by the share alone.
[[nodiscard]] bool same_matter(const Forms& forms, const Form& a, const Form& b);

/// Throws UsageError when the change does not fit a body of these forms.
void check(const Forms& forms, const Event& change);
/// The change that gives the elements of event i the forms back that they had before it. Its new
/// nodes stay, without elements. `before`: the forms before event 0.
[[nodiscard]] Change reverse(Forms before, const Damage& damage, std::size_t i);
/// The same of a body that was as the mesh has it.
[[nodiscard]] inline Change reverse(const Problem& problem, const Damage& damage, std::size_t i) {
  return reverse(Forms(problem), damage, i);
}
/// Whether a change of a body of these forms does what the reverse of the last event does.
[[nodiscard]] bool reverses_last(const Forms& first, const Damage& damage, const Forms& forms,
                                 const Event& change);

}  // namespace sunder::fem
