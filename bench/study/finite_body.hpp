// SPDX-License-Identifier: Apache-2.0
// One cell of the stability study at finite deformation by one way to compute it, step by step, and
// what the yardsticks say of it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/study/finite_board.hpp"
#include "fracture/criterion.hpp"
#include "frame/loads.hpp"

namespace sunder::bench {

struct StepOutcome {
  std::string verdict, reason;
  double u_error = NAN, stress_error = NAN, estimate = NAN;
  int back_solves = 0, calls = 0;
  Deformation deformation;
};

/// What a stress error may be over the tolerance: what is reported may be half of the error in one
/// frame of a hundred (docs/method.md).
constexpr double kBand = 2;

class FiniteBodyOfStudy {
 public:
  /// Throws Error where the way does not compute such a body.
  FiniteBodyOfStudy(const FiniteCell& cell, const SolverOptions& solver);
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  StepOutcome take(const Step& step);

 private:
  [[nodiscard]] Load load_of(const Hands& hands);
  [[nodiscard]] std::vector<double> displacement() const;
  SolveReport solve(const Load& load, StepOutcome& outcome);
  [[nodiscard]] bool usable(const std::vector<double>& before, bool same_body);
  void judge(const Load& load, bool rigid, StepOutcome& outcome);
  [[nodiscard]] bool compare(const Load& load, std::span<const std::uint8_t> destroyed,
                             const std::vector<double>& u, std::span<const Voigt> stress,
                             StepOutcome& outcome);
  struct Rest {
    std::vector<double> u;
    std::vector<Voigt> stress;
  };
  [[nodiscard]] Rest rest_from(const Load& load, std::span<const std::uint8_t> destroyed,
                               const std::vector<double>& u, std::string& reason) const;
  [[nodiscard]] std::vector<double> by_newton(const Load& load,
                                              std::span<const std::uint8_t> destroyed,
                                              const std::vector<double>& u) const;

  double contrast_;
  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<FractureCriterion> criterion_;
  Loads loads_;
  std::unique_ptr<Backend> backend_;
  Load at_;              // of the last step at rest
  bool solved_ = false;  // once
};

}  // namespace sunder::bench
