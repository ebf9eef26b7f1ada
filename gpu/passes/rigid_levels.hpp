// SPDX-License-Identifier: Apache-2.0
// w = B y over groups of nodes on the device, B the two levels of smoothed_levels.hpp: y of
// aggregates is Q^T y, a workgroup each; theirs w = A^-1 y, by the kernel of a small body's groups;
// then w = S y + Q w, an invocation a group. S and Q in fp32, S with as much more on its diagonal
// as rounding may take: B stays symmetric and positive. Sums in fp64.
#pragma once

#include <memory>

#include "gpu/kernels.hpp"
#include "gpu/passes/smoothed_levels.hpp"
#include "gpu/vulkan/commands.hpp"

namespace sunder::gpu {

class RigidLevels {
 public:
  /// For so many groups at most.
  RigidLevels(const KernelFactory& kernels, Index groups);

  /// Aggregates that so many groups make.
  [[nodiscard]] static Index aggregates_of(Index groups);
  /// Device bytes, before they exist: of bodies as wide as long.
  [[nodiscard]] static std::size_t planned_bytes(Index groups);

  /// y: six values a group, w: eight; terms: of y^T w.
  void bind(const vulkan::Buffer& y, const vulkan::Buffer& w, const vulkan::Buffer& terms);
  /// Terms of groups that are no longer there are the owner's to clear.
  void update(const SmoothedLevels& levels);
  /// Adds its sizes to what kernels are told.
  void add_to(shaders::CgPush& push) const;
  void record(vulkan::Commands& commands, const shaders::CgPush& push) const;
  /// The same with sizes of dispatches that the device has written.
  void record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                       const vulkan::Buffer& arguments) const;
  [[nodiscard]] std::size_t bytes() const;
  /// How often it was bound anew: what was recorded before can no longer be submitted.
  [[nodiscard]] int bound() const { return bound_; }

 private:
  void write_sums(const SmoothedLevels& levels);
  void write_aggregates(const GroupBlocks& restriction);
  /// Buffers that are too small are made anew, and what is bound to them.
  void hold(vulkan::Buffer& buffer, std::size_t bytes);
  void bind_all();
  [[nodiscard]] std::uint32_t solve_groups() const {
    return round_up(6 * static_cast<std::uint32_t>(most_), 16) / 4;
  }

  const KernelFactory& kernels_;
  Index most_;                           // aggregates that there is room for
  std::uint32_t aggregates_ = 1, rows_;  // rows_: workgroups of 64 groups
  const vulkan::Buffer *y_ = nullptr, *w_ = nullptr, *terms_ = nullptr;
  bool rebind_ = true;
  int bound_ = 0;
  vulkan::Buffer blocks_, slices_, restriction_, first_, inverse_, of_y_, of_w_, of_terms_;
  struct Pass {
    std::unique_ptr<vulkan::Kernel> kernel;
    std::unique_ptr<vulkan::Binding> binding;
  };
  Pass aggregate_, solve_, expand_;
};

}  // namespace sunder::gpu
