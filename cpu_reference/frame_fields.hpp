// SPDX-License-Identifier: Apache-2.0
// Displacement and stress of the damaged body, each twice: of the solution in work, and as
// published. A solution that fails its checks leaves what is published as it was.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "body/offsets.hpp"
#include "cpu_reference/routes.hpp"
#include "solver/condensed_fields.hpp"
#include "solver/host_fields.hpp"
#include "solver/stress_kernel.hpp"

namespace sunder::cpu_reference {

class FrameFields final : public solver::HostFields {
 public:
  /// `region`: frames compute these alone of a condensed body.
  FrameFields(const DamagedBody& body, const Needs& needs, std::optional<solver::Region> region);
  /// Makes ready for forces() and largest_stress(), whether or not anybody needs stress: it is
  /// stored only for those who do. For a body that is not condensed.
  void keep_forces();

  std::optional<double> take(const Eigen::VectorXd& u) override;
  [[nodiscard]] bool has_forces() const override { return !nodal_forces_.empty(); }
  void forces(Eigen::VectorXd& f) override;
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& u) override;

  /// The displacement in work holds; the route that solved for it knows it outside a region.
  void publish(const InverseRoute& by);
  /// The same for a condensed body whose solution, u, is known everywhere.
  void publish_everywhere(const Eigen::VectorXd& u);
  /// The stress of the published displacement is published as well.
  StressSummary publish_stress();
  /// Of the published displacement, over what a frame computes the stress of.
  [[nodiscard]] Deformation deformation() const;
  /// Takes elements out of deformation().
  void cut_off(std::span<const Index> elements);
  /// Takes elements out of the summary's candidates.
  void exclude_candidates(std::span<const Index> elements);
  /// Follows an event.
  void destroy(std::span<const Index> elements);
  /// Follows a change that the body has recorded: elements with corners at new nodes.
  void change(const fem::Change& change);

  /// What is published and what destroying has left, to go back to.
  struct State {
    std::vector<double> nodal;
    std::optional<solver::CondensedFields::State> condensed;
    std::vector<std::uint8_t> excluded, cut_off;
  };
  [[nodiscard]] State state() const;
  /// The body has gone back already. `revived`: elements destroyed or changed since. The stress is
  /// computed anew, the same bits.
  void restore(const State& state, std::span<const Index> revived);

  /// What is published, at all nodes and elements or some; outside a region at the price of a
  /// solve.
  void read_displacement(std::span<double> displacement) const;
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const override;
  void read_stress(std::span<Voigt> stress) const;
  [[nodiscard]] Voigt read_stress(Index element) const;

  [[nodiscard]] const solver::Region* region() const override;
  /// Elements whose stress a frame computes, and the threads that share it.
  [[nodiscard]] std::size_t stressed() const { return kernel_ ? kernel_->size() : 0; }
  [[nodiscard]] std::size_t threads() const;
  [[nodiscard]] std::vector<BufferPlan> buffers() const;

 private:
  void scatter(const Eigen::VectorXd& u, std::vector<double>& nodal) const;
  [[nodiscard]] Index place(Index element) const {
    return kernel_ ? kernel_->place(element) : kNone;
  }

  const DamagedBody& body_;
  const Problem& problem_;
  mutable std::vector<double> nodal_;                         // outside a region only once read
  std::vector<double> next_nodal_;                            // in work
  mutable std::optional<solver::CondensedFields> condensed_;  // computes what is read
  std::optional<solver::StressKernel> kernel_;
  std::vector<Voigt> stress_, next_stress_;  // published; of the last solution
  bool fresh_ = false;                       // next_stress_ is that of nodal_
  std::vector<double> nodal_forces_;         // K u; also another displacement
  fem::Offsets offsets_;                     // new nodes stand behind the mesh's in what is nodal
  std::vector<double> own_;                  // of the displacement in work: the offsets
  std::vector<std::uint8_t> excluded_;       // per element; empty: there is no summary
};

}  // namespace sunder::cpu_reference
