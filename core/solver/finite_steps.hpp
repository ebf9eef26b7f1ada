// SPDX-License-Identifier: Apache-2.0
// What an iteration at finite deformation asks of a device: states and steps between them. The
// decisions are the minimiser's (finite_minimiser.hpp); the host's own steps are host_steps.hpp.
#pragma once

#include <memory>

#include "body/hyperelastic.hpp"
#include "solver/finite_base.hpp"
#include "sunder/backend.hpp"

namespace sunder::solver {

struct FiniteState;
struct FiniteTarget;

/// Of a state: what a step minimises, |forces left over|, and |forces that act|.
struct FinitePoint {
  double potential = 0, residual = 0, acting = 0;
};

struct FiniteTrial {
  FinitePoint at;      // where it ends
  double slope = 0;    // of the potential along the direction, where it begins
  double winding = 0;  // step . change of the residual
  /// Largest change of an element's stress, and largest stress where it begins: Frobenius norms.
  /// Only where they were asked for.
  double change = 0, largest = 0;
};

class FiniteSteps {
 public:
  virtual ~FiniteSteps() = default;

  /// From a state that is evaluated; steps before are forgotten. All three must live until end().
  /// `base`: null where none is needed.
  virtual FinitePoint begin(const FiniteTarget& target, FiniteBase* base, FiniteState& state) = 0;
  /// The whole step that L-BFGS proposes, or Newton's.
  virtual FiniteTrial whole(bool with_stress) = 0;
  /// So much of the same.
  virtual FiniteTrial part(double of, bool with_stress) = 0;
  /// The trial becomes the state, and is learnt from.
  virtual void take() = 0;
  /// The state goes to begin()'s, without stress where none was asked for.
  virtual void end() = 0;
};

/// A device that holds a body's states and steps. Throws DeviceLost from any call.
class FiniteDevice : public FiniteSteps {
 public:
  /// What its steps go by.
  enum class Needs {
    inverse,  ///< a base with its dense inverse
    nothing,  ///< tangents of its own
    host      ///< it makes none: the host steps
  };
  [[nodiscard]] virtual Needs needs() const = 0;
  /// Reads what counts of the body now, which must outlive it; before anything else.
  virtual void attach(const RestingBody& body) = 0;
  /// All of a state by its displacement, as FinitePotential::evaluate.
  virtual void evaluate(const FiniteTarget& target, bool with_stress, FiniteState& state) = 0;
  /// At a displacement (3 * nodes), per element; of those that count.
  virtual void stress(std::span<const double> u, std::span<Voigt> stress) = 0;
  /// Of conjugate gradients, so far.
  [[nodiscard]] virtual std::size_t inner_iterations() const { return 0; }
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
  [[nodiscard]] virtual std::vector<KernelPlan> kernels() const = 0;
};

}  // namespace sunder::solver
