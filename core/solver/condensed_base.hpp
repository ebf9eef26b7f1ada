// SPDX-License-Identifier: Apache-2.0
// Base `condensed`: X_SS, the inverse restricted to the unknowns S that damage and instruments
// touch. With forces on S alone u_S = X_SS f_S exactly, and an update between unknowns of S stays
// in it: a frame costs what the region is large, whatever the body around it. What u is elsewhere
// is solved for with the factor when somebody asks.
#pragma once

#include <memory>

#include "linear_algebra/factor.hpp"
#include "solver/grown_inverse.hpp"
#include "solver/last_load.hpp"
#include "solver/lost_stiffness.hpp"
#include "solver/region_growth.hpp"
#include "solver/region_product.hpp"

namespace sunder::solver {

/// Forces [N] on the body of `factor` whose solution is that of the damaged one: f + B c, and D u
/// of what was lost between factor and base. An unknown may come twice.
struct Equilibrium {
  /// For forces on so many unknowns, loaded and touched by damage.
  void reserve(std::size_t loaded, std::size_t touched);
  [[nodiscard]] std::size_t bytes() const;
  std::shared_ptr<const linear_algebra::Factor> factor;
  std::vector<Index> dofs;
  std::vector<double> forces;
  std::shared_ptr<const LostStiffness> lost;  // empty: nothing
  std::vector<double> lost_u;                 // u on its unknowns [mm]
};

/// A base as it is at a moment; the inverse is shared, and nobody writes what it is of then.
struct CondensedState {
  std::shared_ptr<const linear_algebra::Factor> factor;
  std::vector<Index> dofs;                    // S
  GrownInverse x;                             // X_SS
  GrownInverse x_of_factor;                   // X_SS without what was lost since
  std::shared_ptr<const LostStiffness> lost;  // since; empty: nothing
  std::vector<Difference> vectors;            // B

  /// For so many unknowns of S and vectors.
  void reserve(std::size_t unknowns, std::size_t differences);
  /// Makes each X_SS one matrix, which takes a while where S has grown.
  void settle();
  /// Lets go of what is shared; the lists keep their room.
  void release();
};

class CondensedBase final : public Base {
 public:
  /// Over the unknowns `dofs`, ascending. Throws Stopped when the work was given up.
  CondensedBase(std::shared_ptr<const linear_algebra::Factor> factor, std::span<const Index> dofs,
                const linear_algebra::FactorWork& work = {});
  /// X_SS of a body that has lost stiffness, all of it within S, since it was factored; `before` is
  /// settled.
  CondensedBase(const CondensedState& before, Eigen::MatrixXd x,
                std::shared_ptr<const LostStiffness> lost);

  [[nodiscard]] Index size() const override { return factor_->cholesky().size(); }
  /// Vectors that leave S make S grow: one solve for their unknowns, where grow_by() has none.
  void push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) override;
  /// S is as it was before the push: later results depend on no way that was taken back. No copy
  /// of a state with more may be in use.
  void pop() override;
  /// A load that leaves S costs one solve; the same load as last time costs nothing, nor does it
  /// after another on all unknowns.
  const Eigen::VectorXd& load(const Forces& forces) override;
  /// Only the entries of S are written; the others keep what they held (0 at first).
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override;
  /// What stands behind the last expand().
  void equilibrium(Equilibrium& of) const;
  /// u on S, of the last expand() or expand_mended().
  [[nodiscard]] const Eigen::VectorXd& on_region() const { return u_; }
  /// What that lacks by the factor's own inverse, D u as a force: with X0 that inverse and
  /// g = X0 (f + B c + D u) - u it is g + X D g. Until the next call.
  [[nodiscard]] const Eigen::VectorXd& drift();
  /// B^T (u + drift()), which expand_mended() goes by; until the next call of this or load().
  [[nodiscard]] const Eigen::VectorXd& project_mended();
  /// expand() and what has drifted by all project_mended() since.
  void expand_mended(const Eigen::VectorXd& c, Eigen::VectorXd& u);
  /// `product` takes what it can of every expand() from now on; it must outlive this. Null: nobody.
  void multiply_by(RegionProduct* product);
  /// The frames have it from now on, and wait where S grows: for that it takes all processors.
  /// `growth` may have columns at hand; it must outlive this. Null: nobody has.
  void grow_by(RegionGrowth* growth) {
    growth_ = growth;
    growing_threads_ = linear_algebra::machine_threads();
  }
  [[nodiscard]] RegionGrowth* growth() const { return growth_; }
  [[nodiscard]] const std::shared_ptr<const linear_algebra::Factor>& factor() const {
    return factor_;
  }
  /// X_SS is more than the factor's own.
  [[nodiscard]] bool drifts() const { return lost_ != nullptr; }
  /// X_SS.
  [[nodiscard]] const GrownInverse& inverse() const { return x_; }
  /// Of B.
  [[nodiscard]] Index count() const { return static_cast<Index>(vectors_.size()); }
  /// Unknowns of S that B touches: columns of X_SS that an expand() reads.
  [[nodiscard]] Index touched() const { return static_cast<Index>(touched_.size()); }
  [[nodiscard]] bool inside(std::span<const Index> dofs) const;
  /// S; at first the unknowns given.
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }
  /// Into one that may have room already.
  void copy_state(CondensedState& to) const;
  [[nodiscard]] std::vector<BufferPlan> buffers() const override;

 private:
  CondensedBase(std::shared_ptr<const linear_algebra::Factor> factor, std::span<const Index> dofs,
                std::shared_ptr<const Eigen::MatrixXd> x);
  void grow(std::span<const Difference> vectors);
  void shrink(std::size_t size);
  [[nodiscard]] const Eigen::VectorXd& project(const Eigen::VectorXd& v);
  void multiply(const Eigen::VectorXd& c);
  void write(Eigen::VectorXd& u) const;
  void collect_forces(const Eigen::VectorXd& c);
  void multiply_there();
  void add_grown_rows(Index from);
  void add_lost_to(Eigen::MatrixXd& columns);
  void add(const GrownInverse& x, std::span<const Index> places, std::span<const double> values,
           double* y);
  void add_product(const GrownInverse& x, const Eigen::VectorXd& v, Eigen::VectorXd& y);
  void apply_inside(std::span<const Index> dofs, std::span<const double> values);
  void apply_everywhere(std::span<const Index> dofs, std::span<const double> values);
  void make_room_everywhere();
  void forget_loads();
  void lose(const double* u, std::span<double> moved, std::span<double> forces) const;
  void find_lost_forces(const Eigen::VectorXd& u);
  void add_lost();

  std::shared_ptr<const linear_algebra::Factor> factor_;
  std::vector<Index> dofs_, place_;            // S, and where in it each unknown is
  GrownInverse x_;                             // X_SS
  GrownInverse x_of_factor_;                   // the same where nothing was lost
  std::shared_ptr<const LostStiffness> lost_;  // between factor_ and x_; empty: nothing
  std::vector<Difference> vectors_;
  struct Before {
    std::size_t vectors, unknowns;  // of S
  };
  std::vector<Before> pushes_;               // what there was before each
  std::vector<Index> touched_, is_touched_;  // places that B touches; per place: where in touched_
  std::vector<double> forces_;               // B c on them
  std::vector<Index> there_;                 // those of them that product_ multiplies
  std::vector<double> forces_there_;
  RegionProduct* product_ = nullptr;
  RegionGrowth* growth_ = nullptr;
  int growing_threads_ = linear_algebra::background_threads();
  std::vector<const double*> starts_;  // of columns that are added up
  struct Loaded {
    LastLoad load;
    Eigen::VectorXd u;          // (X f)_S
    bool outside = false;       // a part of the load is outside S
    Eigen::VectorXd by_factor;  // (X0 f)_S then
  };
  // A residual, which is a load on all unknowns, leaves the last other one what it was: the frame
  // after a full check has no need to solve for its load again.
  Loaded loads_of_some_, loads_of_all_;
  Loaded* last_ = &loads_of_some_;
  std::vector<Index> loaded_;  // places that a load touches
  std::vector<double> loads_;  // those of damage that the host multiplies, or of drift()
  Eigen::VectorXd lacks_, all_forces_;
  Eigen::VectorXd mended_;  // that has drifted since the last expand()
  Eigen::VectorXd u_, projected_, right_side_, solution_;
  // Where stiffness was lost: u on the unknowns of D and D u there.
  std::vector<double> moved_, of_moved_;
  linear_algebra::SolveWork work_;
};

}  // namespace sunder::solver
