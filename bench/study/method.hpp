// SPDX-License-Identifier: Apache-2.0
// Every way in which Sunder can compute a frame, as one list, and what one of them makes of a cell
// of the study.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sunder/backend.hpp"

namespace sunder::bench {

struct Method {
  std::string name;  ///< "cpu inverse eager fp64"
  SolverOptions options;
};

/// Of the CPU, and of the Vulkan device when there is one.
[[nodiscard]] std::vector<Method> methods();

struct Outcome {
  double u_error = 0, stress_error = 0;  ///< against the yardstick (support/accuracy.hpp)
  double residual = 0, estimate = 0;     ///< what the solver reported
  int iterations = 0;
  double first_ms = 0, median_ms = 0;  ///< of the frames: update, load, solve, stress
  std::string verdict;                 ///< ok, polished, rounded, refused, WRONG
  std::string reason;                  ///< of a refusal
};

/// One cell by the yardstick (cpu_reference/plain): a fresh factorisation of the damaged board in
/// fp64, refined with residuals in extended precision.
struct Reference {
  Reference(const Problem& problem, std::span<const Index> removed, std::span<const double> force);
  std::vector<std::uint8_t> ignored;  ///< destroyed elements and pieces cut off
  std::vector<double> u;
  std::vector<Voigt> stress;
  double rounding = 0;  ///< stress error that rounding u to fp32 alone costs
};

/// Removes the elements in events of `batch` and solves after each. When the stress is off by more
/// than the tolerance: "rounded" if handing out u in fp32 explains it (within four times what
/// rounding the exact u costs), else "WRONG".
[[nodiscard]] Outcome run_cell(const Method& method, const Problem& problem,
                               std::span<const double> force, std::span<const Index> removed,
                               std::size_t batch, const Reference& reference);

}  // namespace sunder::bench
