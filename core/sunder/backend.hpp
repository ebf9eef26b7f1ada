// SPDX-License-Identifier: Apache-2.0
// THE interface between the frame (simulation.hpp) and whatever computes it. Few, coarse
// operations; state stays on the backend, a quiet frame returns only small structs.
// Public functions check their arguments once and call the do_* of the backend.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sunder/instrument_forces.hpp"
#include "sunder/problem.hpp"

namespace sunder {

namespace fem {
class DamagedBody;
struct Change;
}  // namespace fem

/// What a scene asks of a backend; nothing else is allocated, built or computed. Asking for what
/// was not planned is a UsageError.
struct Needs {
  bool stress = false;    ///< element stress, for the criterion or for output
  bool yield = false;     ///< ratio to yield with its summary
  bool damage = false;    ///< elements may be destroyed
  bool pristine = false;  ///< displacement of the intact body (method B's remote stress)
  bool split = false;     ///< cracks open faces: elements change corners, nodes come (change())
  bool contact = false;   ///< their lips are kept apart: ties come and go (change())
  std::vector<std::string> left_out;  ///< what this scene does not need, in words
};

/// The load of one solve. Forces act on free dofs (ascending, no dof twice). Every gripped dof
/// (Backend::gripped_dofs) gets its prescribed displacement, in that order.
struct Load {
  std::vector<Index> force_dofs;
  std::vector<double> forces;         ///< [N], same length
  std::vector<double> displacements;  ///< [mm], one per gripped dof
};

/// Other unknowns are gripped than `before`, all that were: these besides, those no longer.
struct GripChange {
  std::span<const Index> grasp, release, before;
};

/// Bases that a body has gone over to: new factors or inverses of it as it is, or on route
/// condensed the last one updated. By laws of finite deformation and in motion those of new
/// tangents.
struct NewBases {
  int count = 0;
  double waited_ms = 0;  ///< how long their making kept frames and calls waiting
  NewBases& operator+=(const NewBases& other) {
    count += other.count;
    waited_ms += other.waited_ms;
    return *this;
  }
};

struct SolveReport {
  double residual = 0;  ///< |f - K u| / |f|, fp64, 0 without load (design.md "Accuracy")
  double error = 0;     ///< estimate: largest |stress(du)| / largest |stress(u)| over live elements
  int iterations = 0;   ///< of conjugate gradients, when they ran
  int back_solves = 0;  ///< applications of the base, those of conjugate gradients left out
  bool unfinished = false;  ///< the next solve() goes on towards rest; never without end
  bool capped = false;      ///< in motion: ended by the cap on iterations, its error not promised
  bool polished = false;    ///< the frame was over tolerance and was refined
  double waited_ms = 0;     ///< for new bases, since the last solve
  double stress_ms = 0;     ///< of its time: the stress that it is checked by; 0: a device's own
};

/// Of a body in motion, after its last step. What it has done is the sum since the start:
/// work = kinetic + strain energy + dissipated (method.md "Motion").
struct MotionState {
  double time = 0;                        ///< [s]
  double kinetic = 0, strain_energy = 0;  ///< [N mm]
  double work = 0;                        ///< of forces, grips and gravity [N mm]
  /// Each by its own formula [N mm]: by damping, by the scheme in time, with what has left broken,
  /// and what the iterations have left of the residual.
  double damped = 0, scheme = 0, broken = 0, unsolved = 0;
  Vec3 momentum = Vec3::Zero();          ///< [t mm/s], i.e. N s
  Vec3 angular_momentum = Vec3::Zero();  ///< about the origin [t mm^2/s]
  [[nodiscard]] double dissipated() const { return damped + scheme + broken + unsolved; }
};

struct Worst {
  Index element = kNone;
  double ratio = 0;
};

/// Over live breakable elements; ties go to the lowest id.
struct StressSummary {
  Worst any;        ///< of all live breakable elements
  Worst candidate;  ///< of those not excluded (exclude_candidates)
  Index over = 0;   ///< how many of all are at or over yield
};

/// How far live elements are deformed: whether the theory of small strains still speaks of them.
struct Deformation {
  double strain = 0;        ///< principal value of sym grad u largest in magnitude, with its sign
  double rotation_deg = 0;  ///< largest, of the polar decomposition of F = I + grad u
  Index inverted = 0;       ///< how many have det F <= 0
};

struct BackendInfo {
  std::string backend;  ///< "cpu", "vulkan"
  std::string device;   ///< marketing name
  std::string driver;
  std::string precision;  ///< "fp64", "fp32", ...
  std::string route, update;
  std::string why;               ///< one sentence: why this route
  std::size_t memory_bytes = 0;  ///< held by the backend
  /// Predicted time of a frame without fracture and with the first one, the decision left out; 0:
  /// the backend predicts nothing.
  double quiet_ms = 0, fracture_ms = 0;
  std::string predicted_by = {};  ///< whose rates; empty: nominal ones of a processor
};

/// Passes that a device times by its own clock, in the order of a frame; the names that
/// take_pass_times() uses.
inline constexpr std::array<const char*, 6> kPasses = {"solve",    "stress", "residual",
                                                       "estimate", "refine", "update"};

struct PassTime {
  const char* pass = "";
  double milliseconds = 0;
};

/// A device on which a backend can run, as `sunder devices` lists it.
struct DeviceInfo {
  std::string backend;  ///< "cpu", "vulkan"
  int index = 0;        ///< among the backend's devices
  std::string name;     ///< marketing name
  std::string driver;
  std::string precisions;  ///< "fp64", "fp32 fp64", ...
  std::string limits;      ///< one line: memory, largest buffer, threads
  bool chosen = false;     ///< by backend = "auto"
  std::string why;         ///< why it is chosen, or why not
  std::string rates;       ///< what it does in a second, as once measured; empty: it was not
};

/// A buffer that a scene makes a backend hold, for `plan`.
struct BufferPlan {
  std::string name;
  std::size_t bytes = 0;
};

/// Something that computes in a frame, for `plan`.
struct KernelPlan {
  std::string name;
  std::string does;  ///< in words, with precision, sizes and threads where they are known
};

/// What preparing predicted fractures has come to so far.
struct PreparationReport {
  Index destroyed = 0;  ///< elements, since something was first prepared
  Index predicted = 0;  ///< of them: those that had been prepared
  double spent_ms = 0;  ///< in quiet frames
  double saved_ms = 0;  ///< in frames with a fracture: what the columns found ready had cost
};

/// A state of a backend, to go back to (Backend::save).
class BackendState {
 public:
  virtual ~BackendState() = default;

 private:
  friend class Backend;
  std::weak_ptr<const int> owner_;
  std::size_t events_ = 0;
  int stage_ = 0;
  bool stress_known_ = false;
};

class Backend {
 public:
  virtual ~Backend();
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  [[nodiscard]] virtual BackendInfo info() const = 0;
  [[nodiscard]] virtual std::vector<BufferPlan> buffers() const = 0;
  /// What a frame runs, that with a fracture included; what a scene does not need is not there.
  [[nodiscard]] virtual std::vector<KernelPlan> kernels() const = 0;
  /// What has happened to it since it was created that its caller should know, a sentence each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }

  /// Turns the device's clock on or off. Off at first: reading it may cost a frame more than the
  /// passes themselves (lavapipe: 15 us each).
  virtual void time_passes(bool) {}
  /// Device time per pass since the last call; empty: no device clock, or it is off.
  [[nodiscard]] virtual std::vector<PassTime> take_pass_times() { return {}; }
  /// Bases since the last call; that of the start is none.
  [[nodiscard]] virtual NewBases take_new_bases() { return {}; }
  /// Reaction forces of the grips between frames, for another thread; after each solve() they
  /// belong to its solution. Null: there are no grips, or the backend has nothing of the kind.
  [[nodiscard]] virtual std::shared_ptr<InstrumentForces> instrument_forces() { return nullptr; }
  /// Whether there are grips, or a host may take hold by some.
  [[nodiscard]] bool has_grips() const {
    return !problem_->gripped_dofs().empty() || (needs_.damage && why_no_grasp().empty());
  }
  /// Publishes to these from the next solve() on: another backend of the same problem, now gone,
  /// did so before.
  virtual void take_over_instrument_forces(std::shared_ptr<InstrumentForces>) {}

  /// Whether preparing those that break by themselves saves this backend anything.
  [[nodiscard]] virtual bool prepares() const { return false; }
  [[nodiscard]] virtual PreparationReport preparation() const { return {}; }
  /// Brings to hand what destroying these elements will need, in place of what was prepared before.
  /// Nothing else changes, no later result by a bit. Those destroyed already are ignored. Where
  /// some lie beyond route condensed's region, a thread begins with it: a host says so where an
  /// instrument comes near.
  void prepare(std::span<const Index> elements);

  /// Loads for the following solves. Throws UsageError when sizes or dofs do not fit.
  void set_load(const Load& load);

  /// Displacement u of the damaged body under the current load, grips included. Refines the
  /// solution until the stress error estimate is under the tolerance; throws NumericalError when
  /// it cannot get there.
  SolveReport solve();

  /// In motion, in place of solve(): a step of dt [s] > 0 towards the load, which acts at its end.
  /// Throws NumericalError when none is found under the tolerance; the state before it stays.
  SolveReport advance(double dt);
  /// In motion; at rest before the first step.
  [[nodiscard]] MotionState motion() const;
  /// In motion: velocity at all nodes, shape (3 * nodes) [mm/s]; 0 where a support holds.
  void read_velocity(std::span<double> velocity) const;
  /// In motion: goes on from these; what supports hold is left at 0.
  void set_velocity(std::span<const double> velocity);

  /// In motion: what supports hold beside internal forces, of the last step's end: viscous forces
  /// and the weight of their own nodes [N].
  [[nodiscard]] Vec3 held_beside() const;

  /// Stress a_e D B u of every element from the last solve, and the summary over yield.
  StressSummary stress();

  /// Of the last stress(): over live elements that are not cut off, on route condensed those of its
  /// region. The rotation to 0.1 %, on Vulkan by an estimate (docs/vulkan.md "Deformation").
  [[nodiscard]] Deformation deformation();
  /// Elements of pieces that nothing holds any more: where they are has no meaning, and they no
  /// longer count in deformation().
  void cut_off(std::span<const Index> elements);

  /// Destroys live elements (one event: one update of rank 6 k). Ids must be valid, distinct, live.
  void destroy(std::span<const Index> elements);

  /// Parts elements (method.md "Split cracks"): none leaves, some come as they were but with
  /// corners at new nodes. One event, as destroy() is.
  void change(const fem::Change& change);
  /// Why no further nodes can be gripped by this backend for this scene, and what can; empty: they
  /// can.
  [[nodiscard]] virtual std::string why_no_grasp() const;
  /// Grips these unknowns, at no factor where a base is there: from now on a load prescribes their
  /// displacement, behind those of all gripped before. What the last solution was can still be
  /// read. They must be unknowns of the problem, distinct, not gripped yet. Throws UsageError
  /// otherwise.
  void grasp(std::span<const Index> dofs);
  /// Lets gripped unknowns go, the problem's own too: they are free from now on. Throws UsageError
  /// where one is not gripped or named twice.
  void release(std::span<const Index> dofs);
  /// Those of the problem that have not been let go, ascending, then those grasped since, in order.
  [[nodiscard]] std::span<const Index> gripped_dofs() const;
  /// The first of them: the problem's.
  [[nodiscard]] std::span<const Index> own_gripped_dofs() const;

  /// Nodes of the mesh and, with ids after theirs, those that changes have brought.
  [[nodiscard]] Index node_count() const;
  /// Patches of pooled volume as damage has split them, until the next event; null: nothing pools.
  [[nodiscard]] const fem::Pools* pools() const;

  /// Takes elements out of StressSummary::candidate for good.
  void exclude_candidates(std::span<const Index> elements);

  /// Displacement of the *intact* body under `load`, at all nodes, shape (3 * nodes).
  void solve_pristine(const Load& load, std::span<double> displacement);

  /// Displacement of the last solve at all nodes (supports included), shape (3 * nodes), mm.
  void read_displacement(std::span<double> displacement) const;
  /// Same at some nodes, new ones too: a quiet frame reads back only what its instruments need.
  void read_displacement(std::span<const Index> nodes, std::span<Vec3> displacement) const;
  /// Stress of the last stress() (that of an earlier solve after a solve() that failed), Voigt
  /// order, shape (elements), MPa.
  void read_stress(std::span<Voigt> stress) const;
  [[nodiscard]] Voigt read_stress(Index element) const;
  /// Force that the grips exert on the body, one per gripped dof, N; 0 where one was grasped since
  /// the last solve.
  void read_reactions(std::span<double> reactions) const;

  /// The state of now, to go back to; null: this backend keeps none for this route, law or scene.
  [[nodiscard]] std::shared_ptr<const BackendState> save() const;
  /// Goes back to a state that save() of this backend gave and from which all since then began:
  /// events are taken back, load and solution are those of then, and every later result is bit by
  /// bit what it would have been. False, and nothing changes: it is another backend's, or cannot be
  /// gone back to. A state holds on to the base that it rests on.
  [[nodiscard]] bool restore(const BackendState& state);

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const Needs& needs() const { return needs_; }
  /// 1 for destroyed elements, per element.
  [[nodiscard]] std::span<const std::uint8_t> destroyed() const;

 protected:
  Backend(std::shared_ptr<const Problem> problem, Needs needs);
  /// The one record of what is destroyed; whoever computes reads it here.
  [[nodiscard]] const fem::DamagedBody& damaged_body() const { return *damaged_body_; }
  /// Drops all events but so many: once nothing beside the frames reads later ones.
  void take_body_back(std::size_t events);
  /// Says of something more that this backend leaves out for this scene.
  void leave_out(std::string what) { needs_.left_out.push_back(std::move(what)); }

 private:
  virtual void do_set_load(const Load& load) = 0;
  virtual SolveReport do_solve() = 0;
  virtual SolveReport do_advance(double dt);
  [[nodiscard]] virtual MotionState do_motion() const { return {}; }
  virtual void do_read_velocity(std::span<double> velocity) const;
  virtual void do_set_velocity(std::span<const double> velocity);
  [[nodiscard]] virtual Vec3 do_held_beside() const { return Vec3::Zero(); }
  virtual StressSummary do_stress() = 0;
  virtual Deformation do_deformation() = 0;
  virtual void do_cut_off(std::span<const Index> elements) = 0;
  virtual void do_destroy(std::span<const Index> elements) = 0;  // damaged_body() knows them
  virtual void do_change(const fem::Change& change);             // damaged_body() knows it
  /// damaged_body() knows it.
  virtual void do_grip(const GripChange& change);
  virtual void do_prepare(std::span<const Index>) {}
  [[nodiscard]] virtual std::unique_ptr<BackendState> do_save() const { return nullptr; }
  /// damaged_body() still knows all events; true: take_body_back() has dropped all but `events`.
  virtual bool do_restore(const BackendState&, std::size_t /*events*/) { return false; }
  virtual void do_exclude_candidates(std::span<const Index> elements) = 0;
  virtual void do_solve_pristine(const Load& load, std::span<double> displacement) = 0;
  virtual void do_read_displacement(std::span<double> displacement) const = 0;
  virtual void do_read_displacement(std::span<const Index> nodes,
                                    std::span<Vec3> displacement) const = 0;
  virtual void do_read_stress(std::span<Voigt> stress) const = 0;
  virtual Voigt do_read_stress(Index element) const = 0;
  virtual void do_read_reactions(std::span<double> reactions) const = 0;

  std::vector<Index> sorted_;  // of destroy()

  void change_grips(std::span<const Index> grasp, std::span<const Index> release);
  enum class Stage { created, loaded, solved, stressed };
  void require(bool condition, const char* what) const;
  void require_motion(std::span<const double> velocity) const;

  std::shared_ptr<const Problem> problem_;
  Needs needs_;
  std::unique_ptr<fem::DamagedBody> damaged_body_;
  Stage stage_ = Stage::created;
  bool stress_known_ = false;                                         // some stress() has succeeded
  std::shared_ptr<const int> self_ = std::make_shared<const int>(0);  // owner of its states
};

}  // namespace sunder
