// SPDX-License-Identifier: Apache-2.0
// The base of statics at finite deformation: the factor of the tangent of a recent state, which
// follows what is destroyed since by the Woodbury identity and what has turned since by the nodes'
// rotations (method.md "Finite deformation").
//
// With T the unknowns of elements that have left, G = (A^-1)_TT and D the sum of their tangents at
// the base's state, (A - D)^-1 = A^-1 + A^-1 E_T M E_T^T A^-1, where M = D + D R S^-1 R^T D,
// G = R R^T, S = I - R^T D R: the tangent without them is positive definite where S is. Unknowns Z
// that nothing reaches any more are held still: G without them is their Schur complement. Nodes
// that have parted since are a border of all this (finite_border.hpp). A patch of pooled volume
// with fewer elements is stiff along another vector, one that a crack has split along several: D
// holds the one before less those after, all at the base's state and pressure, and need not be
// positive semidefinite.
#pragma once

#include <Eigen/Core>
#include <set>
#include <vector>

#include "body/parting.hpp"
#include "body/tangent_pattern.hpp"
#include "linear_algebra/factor.hpp"
#include "solver/finite_border.hpp"
#include "solver/path_columns.hpp"
#include "solver/resting_body.hpp"

namespace sunder::solver {

class FiniteBase {
 public:
  /// Of the tangent at u, as the pattern of the problem says. Throws NumericalError where it is not
  /// positive definite.
  /// What the body refers to must outlive it, its `destroyed` need not.
  FiniteBase(const fem::HyperelasticBody& body, std::vector<double> u, fem::Tangent kind,
             const fem::TangentPattern& pattern, const fem::Inertia& inertia = {},
             const linear_algebra::FactorWork& work = {});

  /// Takes up what is out since the base was made or has followed last. False: an element is back,
  /// more than `most_rank` unknowns are touched, or the tangent without what left is not positive
  /// definite; then another base is needed.
  [[nodiscard]] bool follow(const RestingBody& now, Index most_rank);
  /// The body has parted into another one, whose problem must outlive it, as must its masses (per
  /// unknown; empty: none). follow() comes next. False: something has been gripped since the base
  /// was made; then another one is needed.
  [[nodiscard]] bool part(const Problem& now, const fem::Parting& parting,
                          std::span<const double> mass);
  /// Other unknowns are gripped, as a problem of the same nodes says, which must outlive it: they
  /// are held still by the small matrix. False: nodes have parted, or one that the base holds by
  /// itself has been let go; then another base is needed. follow() comes next.
  [[nodiscard]] bool grip(const Problem& now);
  /// From now on x = Q A^-1 Q^T b, Q the rotations of the nodes from the base's state to u.
  void turn(const RestingBody& now, std::span<const double> u);
  /// Computes A^-1, dense: from now on solve() multiplies by it. What follows is the same.
  void keep_inverse(const linear_algebra::FactorWork& work = {});
  /// x = A^-1 b.
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);
  /// The same of several right sides at once, in their place, the unknowns in an order of the
  /// body's: best the factor's.
  void solve_ordered(const linear_algebra::Supernodes& order, linear_algebra::RowMajor& b);

  /// Of the whole body: not where nodes have parted since.
  [[nodiscard]] bool has_inverse() const { return inverse_.size() > 0 && border_.empty(); }
  /// What a device needs to apply the base as solve() does: x = Q (A^-1 + A^-1 E_T M E_T^T A^-1)
  /// Q^T b.
  struct Turned {
    std::array<Index, 3> unknowns;
    Mat3 q;
  };
  [[nodiscard]] const Eigen::MatrixXd& inverse() const { return inverse_; }
  [[nodiscard]] const std::vector<Index>& touched() const { return touched_; }
  [[nodiscard]] const Eigen::MatrixXd& small() const { return m_; }
  [[nodiscard]] const std::vector<Turned>& turned() const { return turned_; }
  /// Numbers that no other state of these three has ever had.
  struct Stamps {
    std::uint64_t inverse, small, turned;
  };
  [[nodiscard]] const Stamps& stamps() const { return stamps_; }

  /// Unknowns that what has left touches, and new ones.
  [[nodiscard]] Index rank() const { return touched_count() + border_.size(); }
  [[nodiscard]] double inertia() const { return inertia_; }            ///< its factor
  [[nodiscard]] double largest_turn() const { return largest_turn_; }  ///< [rad]

 private:
  void touch(std::span<const Index> unknowns);
  void push_group(std::span<const Index> unknowns);
  void lose(Index element);
  /// What a patch of pooled volume is stiff by, over unknowns of the base.
  struct PatchVector {
    fem::PatchTangent tangent;
    std::vector<Index> unknowns;  // kNone: held
  };
  [[nodiscard]] PatchVector patch_vector(Index patch) const;
  void part_patches(const Problem& now);
  void touch_patches(std::span<const Index> lost, std::vector<Index>& fresh);
  void add_pressure(const PatchVector& patch, double times);
  [[nodiscard]] fem::PatchTangent patch_tangent(Index patch) const;
  void touch_node(Index node, std::vector<Index>& fresh);
  [[nodiscard]] bool correct(const RestingBody& now);
  [[nodiscard]] bool follow_border();
  [[nodiscard]] const fem::Pools* pools() const {
    return pools_ ? pools_.get() : problem_->pools();
  }
  [[nodiscard]] Index touched_count() const { return static_cast<Index>(touched_.size()); }
  void solve_columns(Eigen::MatrixXd& of);
  void solve_by_factor(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                       const Eigen::VectorXd* forces = nullptr);
  void solve_by_inverse(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                        const Eigen::VectorXd* forces = nullptr);
  void solve_group(Eigen::Ref<linear_algebra::RowMajor> b);
  void rotate(const Eigen::VectorXd& from, bool back, Eigen::VectorXd& to) const;

  const Problem* problem_;  // as it has parted
  FiniteBorder border_;
  bool parted_ = false;  // since the border was read
  std::vector<const Law*> laws_;
  std::vector<std::uint8_t> out_;  // per element: not in the base
  std::vector<double> u_;          // of the base
  fem::Tangent kind_;
  std::shared_ptr<const fem::Pools> pools_;  // its patches of pooled volume; null: the problem's
  fem::PatchVolumes patches_;                // at its state
  std::vector<Index> changed_;  // patches of what has left last, or that a crack has split
  // What the small matrix has still of patches that are as they were no longer; elements of those
  // that have been split since.
  std::vector<PatchVector> before_;
  std::set<Index> split_;
  double inertia_;
  linear_algebra::Factor factor_;
  Eigen::MatrixXd inverse_;            // empty: the factor solves
  PathColumns columns_;                // L^-1 E_T
  std::vector<Index> touched_;         // T
  std::vector<Index> column_;          // of each unknown in T; kNone
  std::vector<std::uint8_t> coupled_;  // per unknown: it has an equation of the tangent
  std::vector<std::uint8_t> held_;     // per unknown: gripped since; empty: none is
  bool gripped_ = false;               // others, since the small matrix was made
  Eigen::MatrixXd g_, d_, m_;
  linear_algebra::RowMajor rows_, block_;  // rows of L, all zero between calls; part of G
  std::vector<Index> path_, places_;
  std::vector<Turned> turned_;
  Stamps stamps_;
  double largest_turn_ = 0;
  Eigen::VectorXd y_, p_, c_, back_, on_base_, offsets_;
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::solver
