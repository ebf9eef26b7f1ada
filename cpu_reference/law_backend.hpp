// SPDX-License-Identifier: Apache-2.0
// What statics at finite deformation and motion share as backends of the CPU: the fields of a
// displacement by the laws of its elements, and what a scene may ask of them.
#pragma once

#include <optional>
#include <vector>

#include "body/hyperelastic_pass.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "solver/instrument_block.hpp"

namespace sunder::cpu_reference {

class LawBackend : public Backend {
 protected:
  LawBackend(std::shared_ptr<const Problem> shared, Needs needs);

  [[nodiscard]] std::vector<BufferPlan> field_buffers() const;
  [[nodiscard]] std::vector<KernelPlan> field_kernels() const;
  [[nodiscard]] const fem::HyperelasticBody& body() const { return body_; }
  [[nodiscard]] const fem::HyperelasticBody& intact() const { return intact_; }

  /// Per element 1: its stress is 0.
  [[nodiscard]] virtual std::span<const std::uint8_t> without_stress() const { return destroyed(); }

  std::shared_ptr<InstrumentForces> instrument_forces() override;
  void take_over_instrument_forces(std::shared_ptr<InstrumentForces> forces) override;
  /// Of the last solution, as InstrumentBlock::publish takes it; empty: unknown.
  [[nodiscard]] virtual Eigen::MatrixXd grip_compliance() = 0;
  /// After a solution: to who has asked for the forces of grips.
  void publish_instruments();

  void do_set_load(const Load& load) override { load_ = load; }
  StressSummary do_stress() override;
  Deformation do_deformation() override;
  void do_cut_off(std::span<const Index> elements) override { pass_.cut_off(elements); }
  void do_destroy(std::span<const Index> elements) override;
  void do_exclude_candidates(std::span<const Index> elements) override;
  void do_read_displacement(std::span<double> displacement) const override;
  void do_read_displacement(std::span<const Index> nodes,
                            std::span<Vec3> displacement) const override;
  void do_read_stress(std::span<Voigt> stress) const override;
  Voigt do_read_stress(Index element) const override { return stress_[element]; }

  Load load_;
  std::vector<double> u_;  // of the last solution

 private:
  std::vector<Voigt> stress_;  // of the last stress()
  std::vector<const Law*> laws_;
  fem::HyperelasticBody body_, intact_;
  fem::HyperelasticPass pass_;
  std::vector<std::uint8_t> excluded_;
  std::optional<solver::InstrumentBlock> instruments_;  // once asked for
  std::vector<double> reactions_;
};

/// Bytes of a dense inverse, where the route is that; else 0.
[[nodiscard]] std::size_t inverse_bytes(const Problem& problem);
[[nodiscard]] bool by_inverse(const Problem& problem);

/// Throws DeviceError for options that a body with tangents of its own cannot serve, InputError
/// where there is no room for `bases` of them. Returns the entries of a factor.
std::size_t check_law_options(const Problem& problem, const CpuOptions& options, std::size_t bases);

}  // namespace sunder::cpu_reference
