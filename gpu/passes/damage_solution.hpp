// SPDX-License-Identifier: Apache-2.0
// The small matrices of a deferred update on the device, which solves with them in fp64. The host
// has them too, and tells of each event what it adds to them; all of them come over some frames.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "gpu/kernels.hpp"
#include "gpu/vulkan/commands.hpp"
#include "gpu/where_room.hpp"
#include "solver/damage_solver.hpp"

namespace sunder::gpu {

class DamageSolution final : public solver::DamageSolver {
 public:
  /// Room for so many columns of B and grips; fewer columns than `least` are the host's.
  DamageSolution(const KernelFactory& kernels, Index columns, Index grips, Index least);

  /// The same with room for grasped unknowns beside, for at most so many columns of the damage
  /// itself. Null where `least` is none, where there will never be so many, or where there is no
  /// room (where_room.hpp): the host solves then.
  [[nodiscard]] static std::unique_ptr<DamageSolution> make(const KernelFactory& kernels,
                                                            Index columns, std::size_t gripped,
                                                            std::optional<Index> least,
                                                            const LeaveOut& leave_out = {});
  /// Device bytes of that, before it exists.
  [[nodiscard]] static std::size_t planned_bytes(Index columns, Index grips);
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] bool takes(Index columns, Index grips) const override {
    return columns >= least_ && columns <= most_ && grips <= most_grips_;
  }
  void forget() override;
  void forget_forces() override;
  void change_stiffness(std::span<const Index> rows) override;
  [[nodiscard]] bool follows(Index rank, Index columns) override;
  void update(const linear_algebra::RowMajor& w, const linear_algebra::RowMajor& v, Index rank,
              Index columns, bool subtract) override;
  [[nodiscard]] bool wants_grips() const override { return there_ == There::stiffness; }
  bool bring(const solver::SmallMatrices& all) override;
  void solve(const Eigen::VectorXd& p, std::span<const double> displacement,
             std::span<double> energies, Eigen::VectorXd& x) override;
  void refine(std::span<double> energies, Eigen::VectorXd& x) override;

 private:
  /// What is there, in the order in which it comes: a solution brings one of them.
  enum class There { nothing, compliance, stiffness, all };
  /// As damage_solve.comp has them.
  enum Step : std::uint32_t { kStart, kDisplacement, kLack, kInBase, kRefine, kSteps };
  /// What waits to change [T S], with so many columns: vectors, from there on among all.
  struct Update {
    Index rank = 0, columns = 0;
    std::uint32_t at = 0;
    bool subtract = false;
  };

  void write_columns(vulkan::Buffer& to, const linear_algebra::RowMajor& from, Index first,
                     Index end, Index at = 0);
  void write_vectors(const linear_algebra::RowMajor& w, const linear_algebra::RowMajor* v,
                     const Update& update);
  void follow(const Update& update, Index in_compliance);
  void record_follow();
  void record(Step step, std::uint32_t refinement = 0);
  void record_refinements(std::size_t count);
  void finish(std::span<double> energies, Eigen::VectorXd& x);

  Index most_, most_grips_, least_;
  std::uint32_t rows_;      // of each column, with room
  std::uint32_t of_group_;  // rows of a workgroup
  There there_ = There::nothing;
  Index columns_ = 0, grips_ = 0;                          // as they are now
  Index in_compliance_ = 0, in_stiffness_ = 0, in_s_ = 0;  // columns of G, D and S that are there
  std::vector<Update> updates_;
  std::size_t vectors_used_ = 0;  // by them
  std::vector<Index> stale_;      // columns of D
  std::vector<double> packed_;    // what is written at once
  std::array<std::unique_ptr<vulkan::Kernel>, kSteps> solve_;
  std::unique_ptr<vulkan::Kernel> follow_;
  vulkan::Buffer compliance_, stiffness_, forces_, vectors_, state_, given_, facts_, found_;
  std::array<std::unique_ptr<vulkan::Binding>, kSteps> bindings_;
  std::unique_ptr<vulkan::Binding> follow_binding_;
  vulkan::Commands commands_;
};

}  // namespace sunder::gpu
