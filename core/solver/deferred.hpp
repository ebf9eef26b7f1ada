// SPDX-License-Identifier: Apache-2.0
// Update `deferred`: damage carried by a small matrix over a base that stays pristine. With X the
// base and B differences between unknowns that damage touches (difference_basis.hpp),
// A^-1 = X + X B M B^T X. An element with update vectors B U (method.md "Elasticity" 3) changes M
// by M += Z C^-1 Z^T, Z = U + M B^T X B U, C = I - U^T B^T X B Z: what a frame pays grows with the
// number of touched unknowns, not with the number of fractures. M is only as good as its entries
// 1/alpha larger allow; the forces x = D B^T u that make up for the stiffness D that is gone
// (u = X (f + B x)) are refined in these coordinates, to the base's accuracy. Grips add forces h on
// the gripped unknowns G so that u_G = d; their unit vectors stand in B, those of the base's body
// first, of others that are grasped later where they came. Elements may come as
// well as leave (change.hpp): then M -= Z C^-1 Z^T, C = I + U^T B^T X B Z, and D is signed. New
// unknowns are a border of all this (border.hpp).
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "body/change.hpp"
#include "body/stiffness_difference.hpp"
#include "linear_algebra/filled_blocks.hpp"
#include "solver/base.hpp"
#include "solver/border.hpp"
#include "solver/damage_solver.hpp"
#include "solver/difference_basis.hpp"
#include "solver/update_vectors.hpp"

namespace sunder::solver {

/// What the damage is in the coordinates of B, leading n x n blocks: G = B^T X B, M and D.
struct DamageMatrices {
  linear_algebra::RowMajor compliance, m, d;
};

class Deferred {
 public:
  /// Columns of B that there is room for: more than a rebase lets gather.
  static constexpr Index kReserved = 1024;

  /// The problem must outlive it. Without `damage` nothing will be destroyed, and there is no room
  /// for it. Room for `columns` of B is touched now, for later ones by the frames that need it.
  Deferred(const Problem& problem, std::unique_ptr<Base> base, bool damage = true,
           Index columns = kReserved)
      : Deferred(fem::Forms(problem), std::move(base), damage, columns) {}
  /// Over the base of a body whose elements are of these forms.
  Deferred(const fem::Forms& in_base, std::unique_ptr<Base> base, bool damage = true,
           Index columns = kReserved);

  /// Follows an event: by destroy() where elements leave and none comes, by unit vectors in B where
  /// grips take hold and let go, else by change().
  [[nodiscard]] bool follow(const fem::Event& event);
  /// Follows an event. Returns false and changes nothing when the damaged stiffness is not
  /// positive definite in double precision.
  [[nodiscard]] bool destroy(std::span<const Index> elements);
  /// Follows any change, as destroy() does where elements leave and none comes; the reverse of the
  /// last event takes that back. False also where a piece of the body would hang on nothing, for
  /// which a grip does not count. Throws UsageError when the change does not fit the body.
  [[nodiscard]] bool change(const fem::Event& change);
  /// Prepares the base for the removal of live elements, each by itself.
  void prepare(std::span<const Index> elements);
  [[nodiscard]] double saved_ms() const { return base_->saved_ms(); }
  /// Takes the last events back: every later result that the host solves for is bit by bit what it
  /// was before them.
  void take_back(Index events = 1);
  /// Keeps, every few events, what they have added up to: taking later ones back then adds no more
  /// up again than those since.
  void remember();

  /// u = A^-1 f with u_G = displacement (empty: 0). The forces of the damage are refined until
  /// what they lack has no more energy than `energy_tolerance` [N mm], or rounding. A force on a
  /// new node acts on its parent's unknown and on its own (unknown()).
  void solve(const Forces& forces, std::span<const double> displacement, Eigen::VectorXd& u,
             double energy_tolerance = 0);
  /// The x of solve() with u = X (f + B x), for a device that does that product itself: the first
  /// rank() entries, until the next call.
  const Eigen::VectorXd& coefficients(const Forces& forces, std::span<const double> displacement,
                                      double energy_tolerance = 0);
  /// Refines the forces x of the last solution once by u itself, as B^T u, and holds the grips:
  /// where u is more exact than X (f + B x). No new nodes. Returns x.
  const Eigen::VectorXd& refine_at(const Eigen::VectorXd& u_in_b,
                                   std::span<const double> displacement);
  /// Puts the gripped unknowns where they are held, free of rounding.
  void hold(std::span<const double> displacement, Eigen::VectorXd& u) const;
  /// `solver` solves where it takes a solution's size; it must outlive this, or until the next
  /// call. Null: the host always does.
  void solve_by(DamageSolver* solver);
  /// Solutions are judged by defect_energy() alone, which is all of their error: refining may end
  /// where the next time would bring that under the tolerance.
  void judge_by_energy() { by_energy_ = true; }
  /// Energy r^T A^-1 r of what the last solution lacked before its last refinement, or a bound of
  /// it where the host solved and grips hold the body: r is the residual where damage acts, in the
  /// base's arithmetic.
  [[nodiscard]] double defect_energy() const { return defect_energy_; }
  /// One application of A^-1 with u_G = 0, to the few digits that a correction needs.
  void correct(const Forces& residual, Eigen::VectorXd& du);
  /// The x of correct() for B^T X r.
  const Eigen::VectorXd& correction_coefficients(const Eigen::VectorXd& projection);
  /// Whether the last solution was refined down to `energy_tolerance` or to rounding.
  [[nodiscard]] bool converged() const { return converged_; }
  /// Norm of the last solution's x on differences: the forces of damage, in B [N].
  [[nodiscard]] double forces() const;
  /// Gripped unknowns, as forms().gripped().
  [[nodiscard]] Index grips() const { return static_cast<Index>(held_.size()); }
  /// Force of a grip on the base in the last solution, its anchor included.
  [[nodiscard]] double grip_force(std::size_t grip) const { return x_[held_[grip].column]; }
  /// Of all of them.
  [[nodiscard]] Eigen::VectorXd grip_forces() const;

  /// L with L L^T = (A^-1)_GG.
  [[nodiscard]] const Eigen::MatrixXd& grip_factor() const { return grip_block_.matrixLLT(); }

  [[nodiscard]] Base& base() { return *base_; }
  [[nodiscard]] const Base& base() const { return *base_; }
  [[nodiscard]] Index events() const { return static_cast<Index>(damage_.size()); }
  /// The events that the small matrices hold, in order; their reverses are fem::reverse().
  [[nodiscard]] const fem::Damage& damage() const { return damage_; }
  [[nodiscard]] const fem::Forms& forms() const { return forms_; }
  /// The unknown of a new node's offset: after the body's; kNone where it keeps to its parent.
  [[nodiscard]] Index unknown(Index node, int axis) const;
  /// d [mm] of the last solution or correction: the last unknowns.
  [[nodiscard]] const Eigen::VectorXd& offsets() const { return border_.offsets(); }
  /// Unknowns of destroyed elements, gripped ones of the base's body first.
  [[nodiscard]] std::span<const Index> touched() const { return touched_; }
  /// Columns of B: what a frame pays for the damage.
  [[nodiscard]] Index rank() const { return count_; }
  /// Into the leading blocks of matrices that have room, or get it; throws UsageError where there
  /// are new unknowns, which no base takes over.
  void copy_damage(DamageMatrices& to) const;
  [[nodiscard]] std::vector<BufferPlan> buffers() const;

 private:
  /// By what held before an event.
  struct Before {
    std::size_t touched, differences, units;
    bool pushed;
  };
  /// A gripped unknown, and the column of B that is its unit vector.
  struct Held {
    Index dof, column;
  };
  using Part = fem::StiffnessPart;

  /// What events have added up to.
  struct Sums {
    Index events = 0;
    Eigen::Index changed = 0;
    linear_algebra::RowMajor m, d, grip_compliance, under_grips;
    fem::Forms forms;
    Border border;
  };

  void reserve_for_fractures(Index columns);
  void reserve(Index columns);
  [[nodiscard]] bool follow_last();
  void push(const fem::Event& event, const fem::Forms* after);
  void connect_patches(const fem::Event& event, const fem::Forms& after);
  [[nodiscard]] std::unique_ptr<fem::Forms> forms_after(const fem::Event& event) const;
  void find_patches(const fem::Event& event, const fem::Forms& after);
  void push(std::span<const Difference> vectors);
  void push_units(std::span<const Index> dofs);
  [[nodiscard]] std::array<Index, 4> glued(Index element) const;
  void connect(const std::array<Index, 4>& nodes);
  void pop();
  [[nodiscard]] bool apply(const fem::Event& event, fem::Forms* after);
  void collect(const fem::Event& event);
  void collect(const fem::StiffnessDifference& between);
  void collect_pressure(std::span<const Index> patches, const fem::Forms& before,
                        const fem::Forms& after);
  [[nodiscard]] bool update(std::span<const Part> parts, bool more);
  void gather(std::span<const Part> parts);
  void gather_event(std::span<const Part> parts);
  void add_to_d(bool more);
  [[nodiscard]] bool update_both();
  void collect_all();
  void sum_up_d();
  void sum_up_d(std::span<const Part> parts, bool more);
  [[nodiscard]] bool follow_border(const fem::Event& event, Eigen::Index columns);
  [[nodiscard]] Forces on_body(const Forces& forces);
  [[nodiscard]] bool judge(int refinement, double energy, double tolerance);
  [[nodiscard]] Eigen::Index column_of_grip(Eigen::Index grip) const {
    return held_[static_cast<std::size_t>(grip)].column;
  }
  void update_elsewhere(Eigen::Index width, bool more);
  [[nodiscard]] bool bring_elsewhere();
  [[nodiscard]] bool refine_elsewhere(const Eigen::VectorXd& p,
                                      std::span<const double> displacement, double tolerance);
  [[nodiscard]] bool solve_elsewhere(const Eigen::VectorXd& p, std::span<const double> displacement,
                                     double tolerance);
  void start(const Eigen::VectorXd& p, std::span<const double> displacement);
  [[nodiscard]] double refine(const Eigen::VectorXd& p, std::span<const double> displacement);
  [[nodiscard]] double refine_at_v(std::span<const double> displacement);
  [[nodiscard]] double refine_by_base(std::span<const double> displacement);
  [[nodiscard]] double refine_with_border(std::span<const double> displacement);
  void add_grips(std::span<const double> displacement);
  void solve_grips(std::span<const double> displacement);
  void add_of_grips(Eigen::VectorXd& to) const;
  void add_to_grips(Eigen::Index width, const linear_algebra::RowMajor& signed_zt);
  [[nodiscard]] const Eigen::VectorXd& correct(const Eigen::VectorXd& projection);
  void clear();
  [[nodiscard]] std::size_t go_to_sums();
  [[nodiscard]] bool replay();
  [[nodiscard]] bool factor_grips();
  void find_grips();
  struct Columns {
    const double* data;
    Eigen::Index stride;
  };
  [[nodiscard]] Columns columns_of_grips();
  void subtract_at_grips(const Eigen::VectorXd& x, Eigen::VectorXd& at_grips) const;
  [[nodiscard]] Eigen::Index count() const { return count_; }
  void touch(const std::array<Index, 4>& nodes);

  const Problem& problem_;
  std::unique_ptr<Base> base_;
  std::vector<Held> held_;  // as forms_.gripped()
  Eigen::Index heads_ = 0;  // unit vectors that B begins with: grips of the base's body
  DifferenceBasis basis_;
  Index count_ = 0;                       // columns of B: unit vectors and differences
  std::vector<Index> units_, unit_;       // unknowns with one; per unknown: its column, or kNone
  std::vector<Index> column_;             // of each difference of the basis
  std::vector<Index> touched_;            // gripped unknowns, then by event
  std::vector<std::uint8_t> is_touched_;  // per unknown
  std::vector<Before> before_;            // each event
  fem::Damage damage_;                    // they themselves
  fem::Forms in_base_, forms_;            // before and after them
  Border border_;
  std::vector<Difference> wanted_;  // by what is to be prepared
  std::vector<Difference> fresh_;   // unit vectors that come
  linear_algebra::RowMajor compliance_, m_,
      d_;                                // G = B^T X B, M and the stiffness D that is gone, in B
  linear_algebra::FilledBlocks filled_;  // of D, which is sparse
  bool stiffened_ = false;               // the last event has changed M
  Eigen::Index changed_ = 0;             // rows of M, the first ones, that are not all 0
  linear_algebra::RowMajor grip_compliance_;  // (A^-1)_GG
  linear_algebra::RowMajor under_grips_;      // (M G)^T of the grips, a row each
  linear_algebra::RowMajor grip_columns_;     // of G, where they are not the first ones
  std::vector<Sums> sums_;                    // of fewer events first
  Eigen::LLT<Eigen::MatrixXd> grip_block_{Eigen::MatrixXd(0, 0)};
  // The event in work: what it takes and what it adds, its update vectors and where they act, and
  // what comes of them.
  std::vector<Part> less_, more_;
  std::vector<Index> patches_;  // of pooled volume that it may change
  std::vector<Index> rows_;
  Eigen::Index rank_ = 0;
  struct EventRoom {                // of an event with several elements
    std::vector<Index> rows;        // of its elements, one after the other
    std::vector<double> values;     // six per row
    std::vector<std::size_t> ends;  // per element, in rows
    std::vector<double> w;
    CompressRoom compress;
  } event_;
  linear_algebra::RowMajor u_, columns_, xu_, z_, zt_, product_, gram_, at_grips_;
  Eigen::MatrixXd c_;
  // A solution: u in B, the forces x on B, what they lack, and its products; count() entries each.
  Eigen::VectorXd v_, x_, lack_, gx_, mgx_, forces_, moved_, at_held_;
  double defect_energy_ = 0;
  bool converged_ = true, by_energy_ = false;
  DamageSolver* elsewhere_ = nullptr;  // solves instead where it takes a solution's size
};

}  // namespace sunder::solver
