// SPDX-License-Identifier: Apache-2.0
// New unknowns d, offsets of old ones, as a border of the damaged body (method.md "Changes"). An
// element with corners at new nodes stays in A, the matrix of the old unknowns, as if they were
// their parents; what is new are blocks beside it:
//   [ A          B E ] [u]   [f  ]
//   [ E^T B^T    F   ] [d] = [f_d],   S = F - E^T B^T A^-1 B E.
// With A^-1 = X + X B M B^T X and G = B^T X B (deferred.hpp) S = F - E^T H, H = G N,
// N = E + M G E, and u = X (f + B x) with x = M p - N d, p = B^T X f, S d = f_d - N^T p.
// A patch of pooled volume has one vector over all of its elements' nodes: its part on new unknowns
// stands in E and F, that on old ones in A, which changes where a crack splits the patch.
// An event changes few columns of E, the last ones: what came before them is kept, and the Cholesky
// factor of S grows by a border of its own.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "body/offsets.hpp"
#include "solver/base.hpp"
#include "solver/difference_basis.hpp"

namespace sunder::solver {

class Border {
 public:
  /// Whether there are no new unknowns.
  [[nodiscard]] bool empty() const { return d_.size() == 0; }
  [[nodiscard]] Index size() const { return static_cast<Index>(d_.size()); }
  /// Which new node has which of them.
  [[nodiscard]] const fem::Offsets& unknowns() const { return unknowns_; }

  /// Follows an event that the forms have followed: E and F of the elements at new nodes, all of
  /// them in the basis, S and its factor. E has `columns` rows: `of_basis` says which of them a
  /// difference of the basis has; those of unit vectors are zero. Reads the leading blocks of G and
  /// M; of M no more than `changed` rows are not 0, and with `anew` it is another one than at the
  /// last event. `patches`: of pooled volume that the event may change. False where S is not
  /// positive definite in double precision.
  struct Over {
    std::span<const Index> of_basis;
    Eigen::Index columns = 0, changed = 0;
    bool anew = false;
    std::span<const Index> patches{};
  };
  [[nodiscard]] bool follow(const fem::Forms& forms, const fem::Event& event,
                            DifferenceBasis& basis, const linear_algebra::RowMajor& g,
                            const linear_algebra::RowMajor& m, const Over& over);
  /// No event has happened.
  void clear() { *this = {}; }
  /// Which columns of B are the unit vectors of what is gripped now, in their order.
  void hold(std::vector<Eigen::Index> columns) { grips_ = std::move(columns); }
  /// What the border adds to (A^-1)_GG of the grips.
  void add_to_grips(Eigen::MatrixXd& compliance) const;

  /// Takes forces on unknowns from `first` on as f_d; returns those before it.
  [[nodiscard]] Forces take(const Forces& forces, Index first);
  /// f_d = 0.
  void take_none() { load_.setZero(); }
  /// d by p, and x = M p becomes M p - N d.
  void start(const Eigen::VectorXd& p, Eigen::VectorXd& x);
  /// With v = B^T u: the forces -E d on B join `lack`; what lacks on the new unknowns is kept.
  void add_lack(const Eigen::VectorXd& v, Eigen::VectorXd& lack);
  /// Lets d follow forces on B, of which `by_lack` is G times, and what lacks on the new unknowns;
  /// returns the energy that this adds to that of those forces. The grips' share of the motion
  /// -H dd joins `moved`.
  [[nodiscard]] double correct(const Eigen::VectorXd& by_lack, Eigen::VectorXd& x,
                               Eigen::VectorXd& moved);
  /// Lets d follow forces of the grips.
  void follow_grips(const Eigen::VectorXd& forces, Eigen::VectorXd& x);
  [[nodiscard]] const Eigen::VectorXd& offsets() const { return d_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Entry {
    Index row;
    double value;
  };
  [[nodiscard]] Index first_changed(const fem::Forms& forms, const fem::Event& event,
                                    std::span<const Index> patches);
  [[nodiscard]] std::array<Index, 12> own(const fem::Forms& forms,
                                          const std::array<Index, 4>& corners) const;
  void resize(Eigen::Index rows);
  void assemble(const fem::Forms& forms, DifferenceBasis& basis, std::span<const Index> of_basis,
                Index from);
  void add_ties(Index from);
  void add_patches(const fem::Forms& forms, DifferenceBasis& basis, std::span<const Index> of_basis,
                   Index from);
  void add_patch(const fem::Forms& forms, std::span<const Index> elements, DifferenceBasis& basis,
                 std::span<const Index> of_basis, Index from);
  void add_to_e(Index column, Index row, double value);
  void add(const fem::Forms& forms, const fem::Form& form, DifferenceBasis& basis,
           std::span<const Index> of_basis, Index from);
  void multiply(const linear_algebra::RowMajor& g, const linear_algebra::RowMajor& m,
                const Over& over, Index from, Eigen::Index rows);
  [[nodiscard]] bool factor(Index from);
  void solve(Eigen::VectorXd& d) const;
  void subtract_transposed(const Eigen::VectorXd& p, Eigen::VectorXd& d) const;
  void add_product(const Eigen::VectorXd& d, double sign, Eigen::VectorXd& x) const;

  fem::Offsets unknowns_;
  // An element has few differences: E is sparse, and N = E where nothing but splits has changed.
  std::vector<std::vector<Entry>> e_;  // by column
  Eigen::MatrixXd f_, n_, h_, l_;      // of N the rows beyond E, those of M; l_ l_^T = S
  Eigen::Index rows_of_h_ = 0;
  std::vector<Eigen::Index> grips_;  // rows of H
  std::map<Index, std::array<Index, 4>>
      corners_;                             // of the elements at new nodes, at the last event
  Eigen::VectorXd load_, d_, lack_, step_;  // f_d; d; what lacks on d; a step of d
  std::vector<Index> dofs_;                 // of the forces before f_d
  std::vector<double> values_;
  std::vector<Index> rows_;
  linear_algebra::RowMajor y_;
  // Of a patch of pooled volume: its vector by rows of B and by new unknowns.
  std::map<Index, double> on_old_, on_new_;
};

}  // namespace sunder::solver
