// SPDX-License-Identifier: Apache-2.0
// The frame: loads -> displacement -> stress -> decision -> update, repeated until nothing breaks.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sunder/backend.hpp"
#include "sunder/crack.hpp"
#include "sunder/report.hpp"

namespace sunder {

class FractureCriterion;
class Loads;

/// Derives from a problem what a backend must offer and what it may leave out.
[[nodiscard]] Needs needs_of(const Problem& problem);

class Simulation {
 public:
  /// Takes presets out (event 0 of step 0) at the first step. The backend must have been created
  /// for `problem` with needs_of(*problem) or more.
  Simulation(std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> backend);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Called after each event, with its records; returning false ends the step early (the state
  /// stays consistent; interrupted() is then true).
  using EventObserver = std::function<bool(std::span<const DestroyedElement>)>;
  void observe_events(EventObserver observer) { observer_ = std::move(observer); }

  /// Computes the next step. Throws NumericalError when the promise cannot be kept and UsageError
  /// when all steps are done.
  StepReport step();

  [[nodiscard]] int steps_done() const { return next_step_; }
  [[nodiscard]] bool done() const { return next_step_ >= problem_->scene().steps; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const Backend& backend() const { return *backend_; }
  [[nodiscard]] const std::vector<DestroyedElement>& destroyed() const { return destroyed_; }
  [[nodiscard]] const std::vector<Crack>& cracks() const;
  /// Problem's warnings, then what happened during the run, each once.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// Force each instrument exerts on the body in the last solve, N; pulls and presses: the force
  /// applied, grips: the reaction.
  [[nodiscard]] std::vector<Vec3> reactions() const;
  /// Force that the supports exert on the body; equilibrium: minus the sum of reactions().
  [[nodiscard]] Vec3 support_reaction() const;
  /// Nodes on which instrument i acts at present (pressed nodes included).
  [[nodiscard]] std::vector<Index> acting_nodes(std::size_t instrument) const;

  /// Displacement at all nodes, shape (nodes), mm; zero before the first step.
  [[nodiscard]] std::vector<Vec3> displacement() const;
  /// Element stress, shape (elements), MPa. Throws UsageError when Needs leave stress out.
  [[nodiscard]] std::vector<Voigt> stress() const;

 private:
  void apply_presets();
  void apply_removals();
  void apply_event(std::vector<DestroyedElement> records);
  void report_loose_pieces();
  void warn(std::string message);
  [[nodiscard]] double compliance() const;

  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<Loads> loads_;
  std::unique_ptr<FractureCriterion> criterion_;
  EventObserver observer_;
  std::vector<DestroyedElement> destroyed_;
  std::vector<std::string> warnings_;
  int next_step_ = 0;
  int next_event_ = 0;
  int events_this_step_ = 0;
  bool interrupted_ = false;
};

}  // namespace sunder
