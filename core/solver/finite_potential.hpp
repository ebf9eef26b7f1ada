// SPDX-License-Identifier: Apache-2.0
// What statics at finite deformation minimises: the energy of a body less the work of its load
// (method.md "Finite deformation"), with the forces and stresses of a state on the way.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "body/hyperelastic_pass.hpp"
#include "body/tangent_pattern.hpp"
#include "body/viscosity.hpp"
#include "solver/finite_steps.hpp"
#include "solver/resting_body.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

/// Force per unknown, displacement per gripped dof; in motion inertia besides: springs of every
/// free unknown to where it would go by itself; and viscous forces.
struct FiniteTarget {
  Eigen::VectorXd force;
  std::vector<double> grips;
  fem::Inertia inertia = {};
  const std::vector<double>* ahead = nullptr;  ///< (3 * nodes)
  const fem::Viscosity* viscosity = nullptr;
  double viscous = 0;  ///< its factor: viscous forces are as stiff as so many times the body
};

/// A displacement and what belongs to it.
struct FiniteState {
  std::vector<double> u, f;          // (3 * nodes): displacement, internal forces
  std::vector<double> viscous;       // (3 * nodes): viscous forces; empty: none
  Eigen::VectorXd r;                 // internal forces - load; 0 at gripped and frozen unknowns
  double energy = 0, potential = 0;  // of the elements; what a step minimises
  double acting = 0;                 // |forces|, of the load, of what holds and of inertia
  std::vector<Voigt> stress;         // per element; empty: not asked for
};

class FinitePotential {
 public:
  /// The body must outlive it, and the device, where there is one that evaluates in the host's
  /// place.
  FinitePotential(const RestingBody& body, StressMeasure stress, FiniteDevice* device = nullptr);
  /// What rests has changed.
  void body_changed();
  [[nodiscard]] FiniteDevice* device() const { return device_; }
  /// The host goes on alone.
  void leave_device() { device_ = nullptr; }

  [[nodiscard]] FiniteTarget target(const Load& load) const;
  /// All of a state by its displacement.
  void evaluate(const FiniteTarget& target, bool with_stress, FiniteState& state) const;
  /// Its stress, where that has been left out.
  void complete(FiniteState& state) const;
  /// to.u = from + part * du.
  void move(std::span<const double> from, double part, const Eigen::VectorXd& du,
            std::vector<double>& to) const;
  /// Gripped nodes where the grips want them; frozen ones stay.
  void put_grips(const FiniteTarget& target, std::vector<double>& u) const;
  /// Where u has the gripped dofs.
  [[nodiscard]] std::vector<double> grips(std::span<const double> u) const;
  /// (to - from) of the unknowns.
  void difference(std::span<const double> to, std::span<const double> from,
                  Eigen::VectorXd& s) const;
  /// 0 at gripped and frozen unknowns.
  void hold(Eigen::VectorXd& of_unknowns) const;

  /// The largest |stress - before| of an element that counts, and the largest |stress|: Frobenius
  /// norms of the tensors.
  struct StressChange {
    double change = 0, largest = 0;
  };
  [[nodiscard]] StressChange stress_change(std::span<const Voigt> stress,
                                           std::span<const Voigt> before) const;

  [[nodiscard]] const RestingBody& resting() const { return body_; }
  [[nodiscard]] const Problem& problem() const { return body_.body().problem; }

 private:
  const RestingBody& body_;
  std::vector<std::size_t> grip_places_;  // of gripped dofs in u
  StressMeasure stress_;
  FiniteDevice* device_;
  std::unique_ptr<fem::HyperelasticPass> pass_;
};

}  // namespace sunder::solver
