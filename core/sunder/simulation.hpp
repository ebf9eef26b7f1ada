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
class LooseSearch;
namespace fracture {
class AveragedStrength;
}
struct Decision;
struct Finding;
struct FractureState;
struct NodalForce;

/// Derives from a problem what a backend must offer and what it may leave out.
[[nodiscard]] Needs needs_of(const Problem& problem);

class Simulation {
 public:
  /// Presets are taken out at the first step (event 0 of step 0). The backend must have been
  /// created for `problem` with needs_of(*problem) or more.
  Simulation(std::shared_ptr<const Problem> problem, std::unique_ptr<Backend> backend);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Called after each event, with its records; returning false ends the step early (the state
  /// stays consistent; interrupted() is then true until the next step begins).
  using EventObserver = std::function<bool(std::span<const DestroyedElement>)>;
  void observe_events(EventObserver observer) { observer_ = std::move(observer); }

  /// Called after each solve of a step, when displacement, stress and what is destroyed belong
  /// together: the place to take a snapshot within a step.
  using FrameObserver = std::function<void()>;
  void observe_frames(FrameObserver observer) { frame_observer_ = std::move(observer); }

  /// Drives an instrument by hand from the next step on: its force [N] or displacement [mm], in
  /// place of the scene's value and ramp. Throws UsageError for a value that is not finite.
  void drive(std::size_t instrument, const Vec3& value);
  /// Turns a rigid grip likewise: rotation vector about its nodes' centroid [deg]. Throws
  /// UsageError for any other instrument.
  void turn(std::size_t instrument, const Vec3& rotation);

  /// Says of each rupture which instrument caused it (DestroyedElement::instrument). Two more
  /// solves an event. Throws UsageError for a law of finite deformation: it rests on superposition.
  void attribute_events(bool wanted);

  /// Computes the next step. Throws NumericalError when the promise cannot be kept and UsageError
  /// when all steps are done.
  StepReport step();
  /// In motion: the next step, of dt [s] > 0 in place of the scene's; ramps go by the time that has
  /// passed, over that of all steps of the scene. What breaks in it, all by one state, is gone from
  /// the next step on.
  StepReport step(double dt);

  /// Within a step, for its observers: what its report would say by now, the device's times and
  /// the total left out. Otherwise zeros.
  [[nodiscard]] StepReport so_far();

  [[nodiscard]] int steps_done() const { return next_step_; }
  [[nodiscard]] bool done() const { return next_step_ >= problem_->scene().steps; }
  [[nodiscard]] bool interrupted() const { return interrupted_; }

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const Backend& backend() const { return *backend_; }
  [[nodiscard]] Backend& backend() { return *backend_; }
  [[nodiscard]] const std::vector<DestroyedElement>& destroyed() const { return destroyed_; }
  [[nodiscard]] const std::vector<Crack>& cracks() const;
  /// All tips of all cracks as the last solve leaves them, by crack and tip, each with its K:
  /// between steps what the last decision saw and found too small. In a frame observer K is what
  /// the decision that follows will see. Computed anew at each call, and by nobody who does not
  /// ask; no later result depends on it. Empty before the first step and under model A, which
  /// keeps no cracks; under model "none" K is there with sif = "field".
  [[nodiscard]] std::vector<TipState> tips();
  /// Problem's warnings, then the backend's, then what happened during the run, each once.
  [[nodiscard]] std::vector<std::string> warnings() const;

  /// Force each instrument exerts on the body in the last solve, N; pulls and presses: the force
  /// applied, grips: the reaction.
  [[nodiscard]] std::vector<Vec3> reactions() const;
  /// Force that the supports exert on the body; equilibrium: minus the sum of reactions().
  [[nodiscard]] Vec3 support_reaction() const;
  /// Nodes on which instrument i acts at present (pressed nodes included).
  [[nodiscard]] std::vector<Index> acting_nodes(std::size_t instrument) const;

  /// In motion: velocities at all nodes, shape (nodes) [mm/s].
  [[nodiscard]] std::vector<Vec3> velocity() const;
  /// In motion: the body goes on with these, one per node, all finite; supports stay.
  void set_velocity(std::span<const Vec3> velocity);

  /// The body as split cracks leave it: the problem's mesh with nodes that have come after its own
  /// and the corners that elements have now. Element ids never change.
  [[nodiscard]] Mesh mesh() const;
  /// How far lips of split cracks have overlapped in any step so far, in the direction across the
  /// ideal path [mm]; 0: nowhere.
  [[nodiscard]] double lip_overlap() const { return lip_overlap_; }
  /// Faces that split cracks have opened (nodes of mesh()), by crack.
  [[nodiscard]] std::vector<CrackFace> crack_faces() const;

  /// Displacement at all nodes of mesh(), mm; zero before the first step.
  [[nodiscard]] std::vector<Vec3> displacement() const;
  /// Element stress, shape (elements), MPa. Throws UsageError when Needs leave stress out.
  [[nodiscard]] std::vector<Voigt> stress() const;

 private:
  void apply_presets();
  void apply_removals();
  StepReport compute_step(double dt);
  SolveReport solve();
  void settle_lips(StepReport& report);
  [[nodiscard]] std::span<const Worst> over_yield();
  void record_solve(const SolveReport& solve, StepReport& report);
  [[nodiscard]] FractureState fracture_state(const StressSummary& summary);
  void reserve();
  void decide(const StressSummary& summary);  // fills decision_
  void prepare_next(const StressSummary& summary);
  bool apply_event();  // of decision_; false: nothing broke
  void attribute_event();
  void find_loose();
  void leave_out_loose();
  void measure_deformation(StepReport& report);
  void add_deformation_warnings(std::vector<std::string>& all) const;
  void note(const Finding& finding);
  [[nodiscard]] std::span<const double> pristine_displacement();
  [[nodiscard]] std::span<const NodalForce> instrument_forces();
  void add_grip_forces();
  [[nodiscard]] double compliance();
  [[nodiscard]] double work_of_turn(std::size_t instrument, const Vec3& displacement) const;

  /// What the instruments exert, with room that frames share.
  struct Reactions {
    std::vector<Vec3> forces;        // per instrument
    std::vector<double> grips;       // per gripped dof
    std::vector<Vec3> displacement;  // of an instrument's nodes
  };
  void read(Reactions& r) const;

  /// Steps to which the same thing happened: one warning for all of them.
  struct Steps {
    int count = 0, first = kNone, last = kNone;
    void add(int step);
    [[nodiscard]] std::string sentence(const std::string& what) const;
  };

  /// Steps that go beyond the theory in one way, with the farthest.
  struct Beyond {
    Steps steps;
    double most = 0;
    int at = kNone;
    void add(int step, double value);
  };

  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<Backend> backend_;
  std::unique_ptr<Loads> loads_;
  std::unique_ptr<FractureCriterion> criterion_;
  std::unique_ptr<LooseSearch> loose_;
  std::unique_ptr<fracture::AveragedStrength> averaged_;  // null: strength is judged by element
  EventObserver observer_;
  FrameObserver frame_observer_;
  std::vector<DestroyedElement> destroyed_;
  std::vector<Finding> findings_;  // each once
  std::vector<double> pristine_;   // of this step's expansion load; empty: not computed yet
  // Of the event or the frame in work; they have room from the start.
  std::unique_ptr<Decision> decision_;
  std::vector<Index> event_, next_in_line_;  // elements: to destroy, to prepare
  std::vector<std::uint8_t> taken_;          // by a scripted removal, per element
  std::vector<Finding> of_loads_;
  std::vector<NodalForce> instrument_forces_;
  std::vector<Worst> over_;
  Reactions reactions_;
  int next_step_ = 0;
  double time_ = 0, scene_time_ = 0;  // [s] of the last step; of the step in work or the last
  bool even_ = true;                  // all steps so far were the scene's own
  int next_event_ = 0;
  int gone_ = 0;  // elements destroyed so far
  int events_this_step_ = 0;
  int decisions_this_step_ = 0;
  const StepReport* in_work_ = nullptr;  // of step()
  bool interrupted_ = false;
  bool attribute_ = false;
  Steps capped_, cut_short_, polished_, unfinished_;
  Beyond strained_, turned_, inverted_;
  double lip_overlap_ = 0;
  std::vector<std::uint8_t> cut_off_;  // per element; empty: none yet
  std::vector<Index> newly_cut_off_;
  bool solved_ = false;  // the backend holds fields
  std::size_t loose_nodes_ = 0, loose_pieces_ = 0, loose_elements_ = 0;
  int loose_nodes_step_ = kNone, loose_pieces_step_ = kNone;  // first seen
};

}  // namespace sunder
