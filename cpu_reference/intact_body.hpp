// SPDX-License-Identifier: Apache-2.0
// The intact body's factor, with the displacements that grips prescribe.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "body/analysis.hpp"
#include "body/body_factors.hpp"
#include "body/damaged_body.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/problem.hpp"

namespace sunder::cpu_reference {

/// Prescribed displacements by the compliance block of the gripped dofs G: with C = A^-1 E_G,
/// x + C C_G^-1 (d - x_G) has x_G = d, and the added forces act on G alone.
class Grips {
 public:
  explicit Grips(std::span<const Index> dofs) : dofs_(dofs.begin(), dofs.end()) {}
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

  std::vector<Index> dofs_;
  Eigen::MatrixXd columns_, at_grips_;                        // C and C_G
  Eigen::LLT<Eigen::MatrixXd> block_{Eigen::MatrixXd(0, 0)};  // copied before its first use
  mutable Eigen::VectorXd gap_;                               // room to work in
};

/// Throws NumericalError when the stiffness is not positive definite in double precision.
[[nodiscard]] std::shared_ptr<const linear_algebra::Factor> factor_of(
    const fem::Analysis& analysis);

/// The intact body's factor with its grips; the preconditioner of the CG route where it fits the
/// memory.
struct IntactBody {
  /// `rebases`: factors of the damaged body are to follow.
  IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis);
  /// With a factor that is there already, and others may read too.
  IntactBody(const Problem& problem, bool rebases, const fem::Analysis& analysis,
             std::shared_ptr<const linear_algebra::Factor> of);
  /// x = K0^-1 f with x_G = displacement (empty: 0). By one thread at a time.
  void solve(const Eigen::VectorXd& f, std::span<const double> displacement,
             Eigen::VectorXd& x) const;
  /// The same with other grips.
  void solve(const Eigen::VectorXd& f, const Grips& by, std::span<const double> displacement,
             Eigen::VectorXd& x) const;

 private:
  std::shared_ptr<const linear_algebra::Factor> factor_;

 public:
  const linear_algebra::Factor& factor;
  Grips grips;
  std::unique_ptr<fem::BodyFactors> factors;  // empty without `rebases`, or handed on
  /// The whole inverse where it is there already; empty: nobody has made it, or handed on.
  std::shared_ptr<const Eigen::MatrixXd> inverse;

 private:
  mutable linear_algebra::SolveWork work_;
};

/// The grips of a body as they are now, on the intact one: those that were grasped at run time take
/// a solve each, the first time that somebody asks.
class PresentGrips {
 public:
  /// Both must outlive it.
  PresentGrips(const fem::DamagedBody& body, const IntactBody& intact)
      : body_(body), intact_(intact) {}
  [[nodiscard]] const Grips& now() const;

 private:
  const fem::DamagedBody& body_;
  const IntactBody& intact_;
  mutable std::optional<Grips> others_;
};

}  // namespace sunder::cpu_reference
