// SPDX-License-Identifier: Apache-2.0
// What has parted since a base at finite deformation was made, as a border of its matrix A. In A
// every element has the corners that it had then; a new node moves as the node that it parts from
// plus an offset d. With B and C the tangents, at the base's state, of elements with corners at new
// nodes:
//   [ A    B ] [u]   [f  ]
//   [ B^T  C ] [d] = [f_d],   S = C - B^T A^-1 B, Z = A^-1 B.
// What has left the body besides is a correction A^-1 E_T M E_T^T A^-1 (finite_base.hpp), with
// which S is C - B^T Z - Z_T^T M Z_T.
#pragma once

#include <Eigen/Cholesky>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "body/pooled_law.hpp"

namespace sunder::solver {

class FiniteBorder {
 public:
  /// Of the body that a base is made of.
  explicit FiniteBorder(const Problem& problem);

  /// From now on the body has parted into this one. `mass` [t]: per unknown; empty: it has none.
  /// Both must live until the next part() or the end.
  void part(const Problem& now, std::span<const double> mass);
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// The body is told of by another problem, whose nodes and elements are the same.
  void see(const Problem& now) { now_ = &now; }
  [[nodiscard]] Index size() const { return static_cast<Index>(from_.size()); }
  /// Unknowns of the base.
  [[nodiscard]] Index own() const { return own_; }
  /// As the base's body has them: a new node's is the one that it parts from.
  [[nodiscard]] const std::array<Index, 4>& corners(Index element) const {
    return corners_[static_cast<std::size_t>(element)];
  }

  /// The base's unknown that one of the parted body moves as; kNone: none.
  [[nodiscard]] Index glued(Index unknown) const {
    return unknown < own_ ? unknown : from_[static_cast<std::size_t>(unknown - own_)];
  }

  /// What the base knows of an element and of a patch of pooled volume, and how it solves: columns
  /// of right sides in their place.
  struct Base {
    std::function<fem::ElementMatrix(Index)> tangent;
    std::function<fem::PatchTangent(Index)> patch;
    std::function<void(Eigen::MatrixXd& columns)> solve;
    std::span<const std::uint8_t> out;      ///< per element 1: not in the body
    std::span<const std::uint8_t> coupled;  ///< per unknown of the parted body
    double inertia;                         ///< its factor
  };
  /// Reads all of it anew. M and T are those of what has left. False: S is not positive definite.
  [[nodiscard]] bool follow(const Base& base, const Eigen::MatrixXd& m,
                            std::span<const Index> touched);

  /// Forces on all unknowns as those on the base's, offsets held.
  void gather(const Eigen::VectorXd& forces, Eigen::VectorXd& on_base) const;
  /// d, where the base alone, offsets held, has p = E_T^T A^-1 f at the touched unknowns, and p
  /// less what offsets take from it.
  void solve(const Eigen::VectorXd& forces, const Eigen::VectorXd& on_base,
             const Eigen::MatrixXd& m, Eigen::VectorXd& p, Eigen::VectorXd& d) const;
  /// x, the base's unknowns with what has left counted in, becomes that of all unknowns.
  void add(const Eigen::VectorXd& d, Eigen::VectorXd& x) const;

 private:
  using Column = std::map<Index, double>;
  void add_patches(const Base& base, std::vector<Column>& b, Eigen::MatrixXd& c) const;

  const Problem* now_;
  std::span<const double> mass_;
  Index own_;
  std::vector<std::array<Index, 4>> corners_;
  std::vector<Index> from_;  // per new unknown: the base's that it parts from; kNone: no element
  std::vector<Column> b_;
  Eigen::MatrixXd z_, z_touched_;
  Eigen::LLT<Eigen::MatrixXd> s_;
};

}  // namespace sunder::solver
