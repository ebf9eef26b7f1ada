// SPDX-License-Identifier: Apache-2.0
// Second level of the preconditioner of conjugate gradients: M^-1 = D^-1 + Z B Z^T with the rigid
// motions Z of groups of nodes and B = (Z^T K Z)^-1, or of many groups what rigid_levels.hpp has in
// its place (additive two-level method; e.g. Tang, Nabben, Vuik, Erlangga, J. Sci. Comput. 39,
// 2009). Blocks D alone pass a motion on by one element an iteration, and what a cut sets free is
// held by destroyed elements only: its rigid motions are modes of their own, which cost thousands
// of iterations. At finite deformation Z are the rigid motions of where the nodes are now, and Z^T
// K Z is that of the body at rest, turned with the groups: the stiffness turns so as long as their
// strain is small.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/tangent_pattern.hpp"
#include "gpu/kernels.hpp"
#include "gpu/passes/node_groups.hpp"
#include "gpu/passes/rigid_levels.hpp"
#include "gpu/vulkan/commands.hpp"
#include "sunder/problem.hpp"

namespace sunder::gpu {

class RigidSpace {
 public:
  /// Of the body as it rests: what is destroyed, read live, keeps a `share` of its stiffness; both
  /// must outlive it. `apart`: no group has nodes of volumes of unlike stiffness.
  RigidSpace(const KernelFactory& kernels, const Problem& problem,
             std::span<const std::uint8_t> destroyed, double share, bool apart = false);

  /// Groups that a body in one piece will have.
  [[nodiscard]] static std::size_t planned_groups(const Problem& problem);
  /// Device bytes, before they exist.
  [[nodiscard]] static std::size_t planned_bytes(const Problem& problem, bool apart = false);

  /// Follows an event that the body has recorded already.
  void destroy(std::span<const Index> elements);
  /// These unknowns are gripped from now on, those of the problem at first: all of it is made anew.
  void grip(std::span<const Index> gripped);
  /// Elements are back: all of it is made anew.
  void forget();
  /// Springs of inertia that are in K; where they are much as they were nothing changes.
  void set_inertia(const fem::Inertia& inertia);
  /// Brings the device up to date with the damage and the inertia; before what is recorded next.
  void update();
  /// The same, and with where the nodes are (3 * nodes).
  void update(std::span<const double> u);
  /// Groups of nodes, at least one (an empty one where there is no body).
  [[nodiscard]] std::uint32_t groups() const {
    return std::max(1u, static_cast<std::uint32_t>(groups_.count()));
  }
  /// Workgroups of one of its dispatches, at most.
  [[nodiscard]] std::uint32_t most_workgroups() const;
  /// Adds its sizes to what kernels are told.
  void add_to(shaders::CgPush& push) const;

  void bind(const vulkan::Buffer& r);
  /// w = B Z^T r of the bound vector, and the terms of (Z^T r)^T w.
  void record(vulkan::Commands& commands, const shaders::CgPush& push) const;
  /// The same with sizes of dispatches that the device has written.
  void record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                       const vulkan::Buffer& arguments) const;
  /// RigidLevels::bound().
  [[nodiscard]] int bound() const { return levels_ ? levels_->bound() : 0; }

  // What a kernel needs for z + Z w.
  [[nodiscard]] const vulkan::Buffer& modes() const { return modes_; }
  [[nodiscard]] const vulkan::Buffer& w() const { return w_; }
  [[nodiscard]] const vulkan::Buffer& terms() const { return terms_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// Too little has happened to a large body for other levels.
  [[nodiscard]] bool stays(const NodeGroups::Lists& pieces) const;
  void hold(std::span<const Index> gripped);
  void place_modes(std::span<const double> u);
  void add_all();
  void add_element(Index element, double scale);
  void add_patch(Index patch);
  void add_inertia(Eigen::MatrixXd& to) const;
  void build();
  void invert();
  /// Rigid motions of aggregates of groups, in the motions of these.
  [[nodiscard]] GroupBlocks motions_of_aggregates() const;
  /// Workgroups of the dense level's product, four rows each; whole packs of terms.
  [[nodiscard]] std::uint32_t solve_groups() const { return round_up(6 * groups(), 16) / 4; }
  void turn(std::span<const double> u);
  void upload_inverse(const Eigen::MatrixXd& inverse);
  [[nodiscard]] Eigen::Matrix<double, 3, 6> motion(Index node) const;

  const KernelFactory& kernels_;
  const Problem& problem_;
  Index most_;  // groups that there is room for
  NodeGroups groups_;
  std::span<const std::uint8_t> destroyed_;
  double share_;
  bool changed_ = true;
  fem::Inertia inertia_;
  std::vector<double> mass_;           // that inertia_ refers to
  std::vector<double> size_;           // of the groups
  std::vector<double> shown_;          // u that the device has; empty: the undeformed places
  std::vector<Vec3> centre_;           // of the groups, undeformed
  std::size_t lost_ = 0;               // elements destroyed since the last build
  std::vector<Vec3> place_;            // of every node from its group's centre, by its size
  std::vector<std::uint8_t> held_;     // axes of every node that nothing moves, as bits
  GroupBlocks stiffness_;              // Z^T K Z, at rest, without inertia
  Eigen::MatrixXd resting_inverse_;    // with it; empty: there is none
  std::optional<RigidLevels> levels_;  // of a large body, in place of the inverse
  vulkan::Buffer modes_, first_, members_, inverse_, y_, w_, terms_;
  std::unique_ptr<vulkan::Kernel> restrict_, solve_;
  std::unique_ptr<vulkan::Binding> restrict_binding_, solve_binding_;
};

}  // namespace sunder::gpu
