// SPDX-License-Identifier: Apache-2.0
// The ways of the CPU to apply the inverse of the damaged stiffness. Two are the plain yardstick: a
// dense inverse with eager updates, and conjugate gradients preconditioned by the intact factor.
// Where that factor is larger than the memory an incomplete one takes its place. The others take
// from the engine (core/engine): deferred updates over an inverse, over a factor, or over the
// inverse of a region's unknowns alone.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <chrono>
#include <memory>
#include <vector>

#include "engine/condensed_base.hpp"
#include "engine/deferred.hpp"
#include "fem/analysis.hpp"
#include "fem/factor.hpp"
#include "fem/ordered_stiffness.hpp"
#include "sunder/backend.hpp"

namespace sunder::cpu_reference {

/// Prescribed displacements by the compliance block of the gripped dofs G: with C = A^-1 E_G,
/// x + C C_G^-1 (d - x_G) has x_G = d, and the added forces act on G alone.
class Grips {
 public:
  explicit Grips(std::span<const Index> dofs) : dofs_(dofs) {}
  /// Takes new columns A^-1 E_G, shape (n x dofs). Throws NumericalError when C_G is singular.
  void set_columns(Eigen::MatrixXd columns);
  /// The same out of the whole inverse.
  void read(const Eigen::MatrixXd& inverse);
  /// Moves x so that x_G = displacement (empty: 0). By one thread at a time.
  void hold(Eigen::VectorXd& x, std::span<const double> displacement) const;
  [[nodiscard]] bool none() const { return dofs_.empty(); }
  [[nodiscard]] std::span<const Index> dofs() const { return dofs_; }
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(columns_.size()) * sizeof(double);
  }

 private:
  void factor();

  std::span<const Index> dofs_;
  Eigen::MatrixXd columns_, at_grips_;                        // C and C_G
  Eigen::LLT<Eigen::MatrixXd> block_{Eigen::MatrixXd(0, 0)};  // copied before its first use
  mutable Eigen::VectorXd gap_;                               // room to work in
};

/// The damaged body: which elements are destroyed, and K u.
class DamagedBody {
 public:
  explicit DamagedBody(std::shared_ptr<const Problem> problem);
  void destroy(std::span<const Index> elements);
  /// y = K x over the unknowns, without anchors.
  void apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
  /// Largest stress norm over live elements of the displacement x.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x) const;
  /// Over live ones of some elements.
  [[nodiscard]] double largest_stress(const Eigen::VectorXd& x,
                                      std::span<const Index> elements) const;
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const std::shared_ptr<const Problem>& shared_problem() const { return problem_; }
  /// a_e per element: 1 or alpha.
  [[nodiscard]] std::span<const double> scale() const { return scale_; }
  [[nodiscard]] std::span<const std::uint8_t> destroyed() const { return destroyed_; }

 private:
  std::shared_ptr<const Problem> problem_;
  std::vector<double> scale_;
  std::vector<std::uint8_t> destroyed_;
  mutable std::vector<double> nodal_in_, nodal_out_;
};

struct Applied {
  int iterations = 0;
  bool converged = true;
};

/// What a full check of a base has found (frame_check.hpp): for which load, how much stress [MPa] a
/// residual of 1 N is worth (0: there was no check), and the error of the stress as it came.
struct BaseCheck {
  Load load;
  double stress_of_residual = 0, error = 0;
};

/// One way to apply the inverse of the damaged stiffness, grips held at zero.
class InverseRoute {
 public:
  virtual ~InverseRoute() = default;
  /// Displacement under a load with its grips. `f` is the force over the unknowns.
  virtual Applied solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& x) = 0;
  /// x = A^-1 r with x_G = 0, to at least two digits.
  virtual Applied apply(const Eigen::VectorXd& r, Eigen::VectorXd& x) = 0;
  /// Fills what solve() left out of x: a condensed route solves for its own unknowns only.
  virtual void complete(Eigen::VectorXd&) {}
  /// What complete() would need later on, for the last solve(); false: it left nothing out.
  virtual bool equilibrium(engine::Equilibrium&) const { return false; }
  /// Follows an event; the body has destroyed the elements already.
  virtual void destroy(std::span<const Index> elements) = 0;
  /// Whether prepare() is worth calling.
  [[nodiscard]] virtual bool prepares() const { return false; }
  virtual void prepare(std::span<const Index>) {}
  /// Milliseconds that events have been spared so far.
  [[nodiscard]] virtual double saved_ms() const { return 0; }
  /// Computes anew what updates have worn out; false: this route has nothing of the kind.
  virtual bool rebase() { return false; }
  /// The deferred update, where there is one: it makes a frame's check cheap.
  [[nodiscard]] virtual const engine::Deferred* deferred() const { return nullptr; }
  /// A deferred update may stop refining at this energy of the defect [N mm].
  virtual void set_enough(double) {}
  /// Bases there have been so far: another one needs a full check.
  [[nodiscard]] virtual int bases() const { return 1; }
  /// Of the newest base, if whoever made it has checked it.
  [[nodiscard]] virtual const BaseCheck& base_check() const {
    static const BaseCheck none;
    return none;
  }
  /// Milliseconds that frames have waited for a rebase so far.
  [[nodiscard]] virtual double waited_ms() const { return 0; }
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
};

/// The intact body's factor with its grips; the preconditioner of the CG route where it fits the
/// memory.
struct IntactBody {
  /// `rebases`: factors of the damaged body are to follow.
  IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis);
  /// x = K0^-1 f with x_G = displacement (empty: 0). By one thread at a time.
  void solve(const Eigen::VectorXd& f, std::span<const double> displacement,
             Eigen::VectorXd& x) const;
  fem::Factor factor;
  Grips grips;
  std::unique_ptr<fem::OrderedStiffness> stiffness;  // empty without `rebases`, or handed on

 private:
  mutable fem::SolveWork work_;
};

/// An incomplete factor of the intact stiffness, with as many entries as the stiffness has.
class IncompleteFactor;

[[nodiscard]] std::unique_ptr<InverseRoute> dense_inverse_route(const DamagedBody& body,
                                                                const IntactBody& intact);
/// Deferred update over a dense inverse (`dense`) or over the factor itself. Takes the intact
/// body's stiffness; without one nothing will be destroyed. `rest`: of the thread that makes new
/// bases (background_rebase.hpp).
[[nodiscard]] std::unique_ptr<InverseRoute> deferred_route(const DamagedBody& body,
                                                           IntactBody& intact, bool dense,
                                                           std::chrono::milliseconds rest);
/// Deferred update over the inverse restricted to some unknowns (ascending).
[[nodiscard]] std::unique_ptr<InverseRoute> condensed_route(const DamagedBody& body,
                                                            const IntactBody& intact,
                                                            std::span<const Index> dofs,
                                                            bool damage,
                                                            std::chrono::milliseconds rest);
/// What solve_whole() works in.
struct WholeRoom {
  /// For a body of so many unknowns, some of them touched.
  void reserve(Index unknowns, std::size_t touched);
  [[nodiscard]] std::size_t bytes() const;
  Eigen::VectorXd right_side;
  std::vector<double> lost;
  fem::SolveWork work;
};
/// u at all unknowns.
void solve_whole(const engine::Equilibrium& of, WholeRoom& room, Eigen::VectorXd& u);
[[nodiscard]] std::unique_ptr<InverseRoute> conjugate_gradient_route(const DamagedBody& body,
                                                                     const IntactBody& intact);
/// Conjugate gradients without any factor, for bodies whose factor is larger than the memory;
/// `preconditioner` may serve several bodies of one problem.
[[nodiscard]] std::unique_ptr<InverseRoute> incomplete_route(
    const DamagedBody& body, std::shared_ptr<const IncompleteFactor> preconditioner);
[[nodiscard]] std::shared_ptr<const IncompleteFactor> incomplete_factor(const Problem& problem);

/// The intact body where there is no factor of it.
class NeverDamaged {
 public:
  NeverDamaged(std::shared_ptr<const Problem> problem,
               std::shared_ptr<const IncompleteFactor> preconditioner)
      : body_(std::move(problem)), route_(incomplete_route(body_, std::move(preconditioner))) {}
  /// Throws NumericalError when conjugate gradients do not converge.
  void solve(const Load& load, const Eigen::VectorXd& f, Eigen::VectorXd& x) const;

 private:
  DamagedBody body_;
  std::unique_ptr<InverseRoute> route_;
};

}  // namespace sunder::cpu_reference
