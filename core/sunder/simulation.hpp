// SPDX-License-Identifier: Apache-2.0
// The frame: loads -> displacement -> stress -> decision -> update, repeated until nothing breaks.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sunder/backend.hpp"
#include "sunder/crack.hpp"
#include "sunder/finished_frames.hpp"
#include "sunder/report.hpp"

namespace sunder {

struct Action;
namespace action {
struct Grasp;
}
struct MarkedState;
struct Tool;
class FractureCriterion;
class Loads;
class LooseSearch;
namespace fracture {
class AveragedStrength;
struct PassedFace;
}  // namespace fracture
struct Decision;
struct Finding;
struct FractureState;
struct NodalForce;

/// Derives from a problem what a backend must offer and what it may leave out.
[[nodiscard]] Needs needs_of(const Problem& problem);

/// A state that a simulation was in, to come back to: Simulation::save. Cheap to copy; it holds on
/// to some memory of the solver's while it lives.
using Mark = std::shared_ptr<const MarkedState>;

/// Where a grip of a host is: a place [mm], and a rotation since it took hold as a quaternion
/// (x, y, z, w) of any length above 0.
struct Pose {
  Vec3 position = Vec3::Zero();
  std::array<double, 4> quaternion{0, 0, 0, 1};
};

/// What a grip exerts on the body: force [N], and torque about the grip's place [N mm].
struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

/// What going back or forward has done.
struct Travel {
  int events = 0;         ///< taken back, or done again
  bool replayed = false;  ///< by doing again what led there from the start, at its price
};

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

  /// Takes live elements out between two steps, by one event with cause script: the same change as
  /// a rupture. Where there has been a solution, in statics, it is computed anew under the same
  /// load, and what is read and felt follows at once; what breaks by it breaks in the next step.
  /// Throws UsageError, and nothing changes, for an element that is not there, named twice or
  /// gone already, and where nothing can be destroyed (Scene::live). Throws NumericalError where
  /// the body has no solution: the elements are gone then.
  void remove(std::span<const Index> elements);

  /// Removes the live elements that a blade has passed: those whose inside, as displacement leaves
  /// them now, any of these triangles [mm] meets. Two places of a blade's edge one after the other
  /// make two triangles. Returns how many. Where cracks split, nothing is removed: faces between
  /// live elements on both sides of the blade open, as a crack with tips that later steps may
  /// drive, and their number is returned. A node that a support holds parts as little as by cracks
  /// that grow. Throws UsageError, and nothing changes, for a blade that is not finite, one that
  /// lies along the board's plane, or more new nodes than fracture.max_new_nodes allows.
  int cut(std::span<const std::array<Vec3, 3>> swept);

  /// Of the elements that a host names, so many count.
  static constexpr std::size_t kNamed = 128;
  /// Says which elements a host may soon remove, cut or grasp, the likeliest first, in place of
  /// those it has named before: none ends it. What the route needs for the first kNamed of them is
  /// brought to hand: on route condensed, where some lie beyond its region, by a thread, for some
  /// 85 nodes; on route factor of the CPU, and inverse once a factor has taken its place, at once
  /// and again in quiet steps after an event; elsewhere there is nothing. No result changes by a
  /// bit, and no history has it. Those gone already are ignored. Throws UsageError, and nothing
  /// changes, for an element that is not there, and where nothing can be destroyed (Scene::live).
  void prepare(std::span<const Index> elements);
  /// The same of the live elements with a corner within a radius [mm] of a place now, the nearest
  /// first. Returns how many there are. Reads where all nodes are, which on route condensed takes a
  /// solve with the factor. UsageError also for a place or radius that is not finite, or a radius
  /// that is not above 0.
  int prepare(const Vec3& near, double radius);

  /// Makes the backend of the same problem once more, as it was before the first step.
  using MakeBackend = std::function<std::unique_ptr<Backend>()>;
  /// Takes hold of nodes, all of their axes, where they are now: nothing moves by it. Rigid: they
  /// move as one solid, which may turn, about its place, the mean of theirs; else as points that
  /// all go the same way. No factor is made for it in statics by law linear (docs/embedding.md "A
  /// live body"). Returns the grip's id, after those of the scene's instruments; none comes twice.
  /// Throws UsageError, and nothing changes, for a node that is not there, named twice, held by a
  /// support or another grip, or of which all elements are gone; where nothing can be destroyed
  /// (Scene::live) or the backend cannot. Where a node of the mesh has parted, or parts later, its
  /// grip holds the lip that keeps the node, and the other one is free.
  int grasp(std::span<const Index> nodes, bool rigid = false);
  /// The same of all nodes that are within a radius [mm] of a place now and could be grasped; the
  /// grip's place is that one. UsageError where there are none.
  int grasp(const Vec3& near, double radius, bool rigid = false);
  /// Brings a grip there, from the next step on, its nodes with it, by an exact rotation. Throws
  /// UsageError for a grip that is not there or has been let go, a value that is not finite, a
  /// quaternion of length 0, and a turn of points.
  void pose(int grip, const Pose& pose);
  /// Where a grip is: its place [mm].
  [[nodiscard]] Vec3 centre_of(int grip) const;
  /// What a grip exerts on the body in the last solve; zero before the first one since it took
  /// hold.
  [[nodiscard]] Wrench wrench(int grip) const;
  /// Forces of all grips between frames, for one other thread, which says of a host's grips where
  /// hands have them (Hand) and is told when this simulation is gone. Null where the backend gives
  /// none: update eager, route cg. By the laws of finite deformation and in motion each step finds
  /// them anew once they were asked for.
  [[nodiscard]] std::shared_ptr<InstrumentForces> grip_forces();
  /// Fields of the last finished frame, for one other thread: as after each step, each removal that
  /// a solution followed, and where undo, redo and the like have led to. Those asked for before
  /// end. Throws UsageError for a node that is not there, and stress where it was left out.
  [[nodiscard]] std::shared_ptr<FinishedFrames> finished_frames(FinishedFields fields);
  /// Nodes that a grip holds, as they were named.
  [[nodiscard]] std::span<const Index> held_nodes(int grip) const;
  /// Lets go: from the next step on the body is as if it had never been held there. A grip of the
  /// scene's own, by its instrument's number, lets go for good: it prescribes nothing any more, its
  /// reaction is zero, and its nodes can be grasped. Throws UsageError, and nothing changes, for a
  /// grip that is not there or has let go; for one of the scene where nothing can be grasped, where
  /// in statics grips of the scene alone hold the body, and where a crack of split nodes has
  /// reached a node that it holds.
  void release(int grip);
  /// A force [N] in equal parts on nodes, from the next step on until it is dropped; what acts on
  /// held axes goes into the reaction there. Returns an id as grasp() does. Throws UsageError for a
  /// node that is not there, named twice or held on all axes by a support, a force that is not
  /// finite.
  int push(std::span<const Index> nodes, const Vec3& force);
  /// A push acts on these nodes, with this force, from the next step on.
  void move(int push, std::span<const Index> nodes, const Vec3& force);
  /// A push ends.
  void drop(int push);

  /// Keeps what is done from now on, so that it can be undone; before the first step and action.
  /// `quick`: the last so many actions in which something broke keep what the solver needs to go
  /// back without a new base: all but the mesh's nodes, some lists and loads is shared. Going
  /// further, or where the route or law keeps nothing (docs/embedding.md), does again what was done
  /// before, on a backend by `make`; without it that is refused. Each step and action adds some 100
  /// bytes. Throws UsageError later on.
  void keep_history(MakeBackend make = {}, int quick = 100);
  /// The state of now. Throws UsageError without keep_history().
  [[nodiscard]] Mark save();
  /// Comes back to a state, from wherever: every later result is bit by bit what it would have been
  /// there. Throws UsageError for a mark of another simulation, or where that needs a new backend.
  Travel restore(const Mark& mark);
  /// Takes back the last `actions` of these: steps and removals in which something broke, grips and
  /// pushes that came or went; with all steps, poses and whatever else since. Throws UsageError,
  /// and nothing changes, where there are fewer.
  Travel undo(int actions = 1);
  /// Does again what undo() took back, quiet steps that came after it included. Throws UsageError
  /// where there is less, as after any step or action since.
  Travel redo(int actions = 1);
  /// Goes on with a new backend by keep_history()'s `make`, where the device of the one before is
  /// lost: does again all that was done, to the same bits, and can take back what it could. Throws
  /// UsageError without a history or `make`, and what `make` throws: nothing changes then. A step
  /// that fails on the way (NumericalError, DeviceLost) ends it there.
  void renew_backend();
  /// The history as bytes: what was done, with where steps ended; not the body. Throws UsageError
  /// without keep_history().
  [[nodiscard]] std::vector<std::uint8_t> store() const;
  /// Does what such bytes tell, from the beginning: the same bits on the same backend. Throws
  /// InputError, and nothing changes, where they are damaged, of another version or another body.
  Travel load(std::span<const std::uint8_t> bytes);
  /// Takes such bytes to be played step by step, with observers, in place of what load() does at
  /// once; keeps a history, which takes nothing back quickly. Throws as load() does, and UsageError
  /// once anything has been done. A body that is live (Scene::live) plays what one that is not has
  /// recorded and the other way round, but for route condensed.
  void open_recording(std::span<const std::uint8_t> bytes);
  /// Does what the recording has before its next step; false: there is none.
  [[nodiscard]] bool reach_recorded_step();
  /// The recording's next step. What an observer ends earlier is as step() says.
  StepReport recorded_step();
  /// How many actions undo() and redo() can take.
  [[nodiscard]] int undos() const;
  [[nodiscard]] int redos() const;

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

  /// The same with a bound on its time in place of solver.max_ms: once `max_ms` [ms] have passed at
  /// the end of an event the step ends with the solution that follows (StepReport::out_of_time);
  /// what is still to break is left to the next one. 0: none. Throws UsageError for any other value
  /// that is not finite and above 0.
  StepReport step_within(double max_ms);
  /// Before the first step: does once what a step does first, and solves for loads that span what
  /// the scene's instruments can do, whichever way they are driven, and a host's grips and pushes
  /// that are there already: what checks find of these stays known, so that the first step costs
  /// what the second does. Later results may differ from those of a cold simulation by what the
  /// tolerance allows; a history has it, so that what is done again has the same bits. Instruments
  /// that press, for which there is no crack yet, and preset cracks, which come out at the first
  /// step, are left to that. Nothing in motion, by the laws of finite deformation, which go on from
  /// where they are, or later on; on route cg, which checks every solution, no loads are solved
  /// for.
  void warm_up();

  /// Within a step, for its observers: what its report would say by now, the device's times and
  /// the total left out. Otherwise zeros.
  [[nodiscard]] StepReport so_far();

  [[nodiscard]] int steps_done() const { return now_.next_step; }
  [[nodiscard]] bool done() const { return now_.next_step >= problem_->scene().steps; }
  [[nodiscard]] bool interrupted() const { return now_.interrupted; }

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const std::shared_ptr<const Problem>& shared_problem() const { return problem_; }
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
  /// Force that the supports exert on the body; equilibrium: minus the sum of reactions(), and of
  /// what grips and pushes of a host exert.
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
  [[nodiscard]] double lip_overlap() const { return now_.lip_overlap; }
  /// Corners of all elements where split cracks have changed them, nodes of mesh(); empty: as the
  /// problem's mesh has them.
  [[nodiscard]] std::span<const std::array<Index, 4>> corners() const;
  /// Piece that an element belongs to, by its first element: kNone: supports and grips hold it, or
  /// it is destroyed. As of the last step or removal in which something broke.
  [[nodiscard]] Index piece_of(Index element) const;
  /// How often pieces have been looked for.
  [[nodiscard]] std::uint64_t looks() const { return looks_; }
  /// Faces that split cracks have opened (nodes of mesh()), by crack.
  [[nodiscard]] std::vector<CrackFace> crack_faces() const;

  /// Displacement at all nodes of mesh(), mm; zero before the first step.
  [[nodiscard]] std::vector<Vec3> displacement() const;
  /// Element stress, shape (elements), MPa. Throws UsageError when Needs leave stress out.
  [[nodiscard]] std::vector<Voigt> stress() const;

 private:
  [[nodiscard]] std::shared_ptr<const Problem> parted_now() const;
  [[nodiscard]] Vec3 pooled_reaction(std::span<const Vec3> displacement) const;
  void apply_presets();
  void apply_removals();
  StepReport compute_step(double dt);
  SolveReport solve();
  void settle_lips(StepReport& report);
  [[nodiscard]] std::span<const Worst> over_yield();
  void record_solve(const SolveReport& solve, StepReport& report);
  [[nodiscard]] FractureState fracture_state(const StressSummary& summary);
  void reserve();
  void reserve_in_line();
  void decide(const StressSummary& summary);  // fills decision_
  void prepare_next(const StressSummary& summary);
  void require_damage(const std::string& verb) const;
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
  std::shared_ptr<InstrumentForces> haptics_;  // null: nobody has asked
  std::shared_ptr<FinishedFrames> frames_;     // the same
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
  std::vector<Index> named_;                 // those that a host wants prepared
  std::vector<std::uint8_t> taken_;          // by a scripted removal, per element
  std::vector<Finding> of_loads_;
  std::vector<NodalForce> instrument_forces_;
  std::vector<Worst> over_;
  Reactions reactions_;
  /// Where the run is: what a state of it is made of beside cracks, loads and the backend.
  struct Now {
    int next_step = 0;
    double time = 0, scene_time = 0;  // [s] of the last step; of the step in work or the last
    bool even = true;                 // all steps so far were the scene's own
    bool preset = false;              // presets are out
    int next_event = 0;
    int gone = 0;  // elements destroyed so far
    bool interrupted = false, out_of_time_now = false;
    bool attribute = false;
    Steps capped, cut_short, polished, unfinished, out_of_time;
    Beyond strained, turned, inverted;
    double lip_overlap = 0;
    std::vector<std::uint8_t> cut_off;  // per element; empty: none yet
    bool solved = false;                // the backend holds fields
    bool warm = false;                  // warm_up() has left a solution that nobody has asked for
    std::size_t loose_nodes = 0, loose_pieces = 0, loose_elements = 0;
    int loose_nodes_step = kNone, loose_pieces_step = kNone;  // first seen
  };
  struct Kept;
  struct History;
  friend struct MarkedState;
  using Actions = std::vector<std::shared_ptr<const Action>>;

  void set_up();
  template <class Do>
  void act(Action action, Do&& body);
  void record(Action action, std::shared_ptr<const Kept> before, int events_before);
  void perform(const std::shared_ptr<const Action>& action);
  StepReport take_step(std::optional<double> dt, double max_ms);
  int take_hold(const action::Grasp& what);
  void require_grasp() const;
  void check_push(std::span<const Index> nodes, const Vec3& force) const;
  [[nodiscard]] std::string why_not(Index node) const;
  [[nodiscard]] std::vector<Vec3> displacement_of(std::span<const Index> nodes) const;
  [[nodiscard]] const Tool& tool(int id, bool holds) const;
  void follow_grips(bool looks);
  void describe_grips();
  [[nodiscard]] std::vector<Index> own_grips() const;
  void release_own(std::size_t instrument);
  void check_release(std::size_t instrument) const;
  void refuse_let_go(std::size_t instrument, const std::string& what) const;
  void finish_frame();
  void arrive();
  [[nodiscard]] double work_of_tools();
  void take_out(std::span<const Index> elements);
  int cut_faces(std::span<const std::array<Vec3, 3>> swept);
  void open_faces(const std::vector<fracture::PassedFace>& faces);
  [[nodiscard]] std::vector<std::uint8_t> gone_to_blade() const;
  void begin_by_hand();
  void finish_by_hand();
  void check_removal(std::span<const Index> elements) const;
  void follow_removal();
  void try_load(const Load& load);
  [[nodiscard]] std::shared_ptr<const Kept> keep() const;
  [[nodiscard]] bool go_back(const Kept& kept);
  void begin_anew();
  [[nodiscard]] bool go_to(const Actions& actions, const std::shared_ptr<const Kept>& kept);
  void require_history() const;
  [[nodiscard]] bool replaying() const;
  void end_step_early();
  [[nodiscard]] bool ended_early() const { return now_.interrupted || now_.out_of_time_now; }

  Now now_;
  int events_this_step_ = 0;
  int decisions_this_step_ = 0;
  const StepReport* in_work_ = nullptr;  // of step()
  std::vector<Index> newly_cut_off_;
  std::uint64_t looks_ = 0;
  std::unique_ptr<History> history_;  // null: none is kept
  double max_ms_ = 0;                 // of the step in work
  std::chrono::steady_clock::time_point began_;
};

}  // namespace sunder
