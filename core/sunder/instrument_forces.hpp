// SPDX-License-Identifier: Apache-2.0
// Reaction forces of the grips between frames: the compliance of the gripped unknowns answers at
// 1 kHz, on a thread of its own, while the next frame is computed.
#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sunder/handover.hpp"
#include "sunder/types.hpp"

namespace sunder {

/// A grip that a host took hold by at run time, as a solution knows it.
struct HeldGrip {
  int id = 0;                  ///< Simulation::grasp()
  bool rigid = false;          ///< it turns its nodes with it
  std::size_t first = 0;       ///< place of its first unknown among the gripped ones; three a node
  Vec3 centre = Vec3::Zero();  ///< where it took hold [mm]
  std::vector<Vec3> moved, arms;  ///< of each node: displacement then, place from the centre
};

/// Where a hand has such a grip between frames, and what it feels there.
struct Hand {
  int grip = 0;
  Vec3 position = Vec3::Zero();                  ///< as Pose [mm]
  std::array<double, 4> quaternion{0, 0, 0, 1};  ///< x, y, z, w; of points it is not read
  Vec3 force = Vec3::Zero();                     ///< on the body [N]
  Vec3 torque = Vec3::Zero();                    ///< on the body, about `position` [N mm]
  bool held = false;  ///< false, with no force: let go, or no solution holds it yet
};

enum class FeltState {
  waiting,  ///< no solution: before the first one, or gone back to before it
  live,
  gone,     ///< the simulation was destroyed
  overflow  ///< displacements that are not finite, or so large that forces overflow
};

/// What forces come from.
struct Felt {
  FeltState state = FeltState::waiting;
  std::uint64_t solution = 0;  ///< its number, from 1 on in the order of solutions
  int step = kNone;            ///< the step that it belongs to; kNone: unknown
  double age_ms = 0;           ///< since it was found
  double share = 1;            ///< of this solution, below 1 while one before it is blended in
};

/// With L L^T the compliance C of the gripped unknowns G and u_0 their displacement without grips,
/// prescribed displacements d take the forces C^-1 (d - u_0). G: those of the scene's grips that
/// hold, then those of a host's.
///
/// One thread publishes, one other thread asks; neither ever waits for the other, and the asking
/// one sees a whole frame or the whole one before it.
class InstrumentForces {
 public:
  using Clock = std::chrono::steady_clock;

  /// `anchors`: stiffness [N/mm] of each gripped unknown's anchor of the scene's grips, whose share
  /// is no reaction.
  explicit InstrumentForces(std::span<const double> anchors);

  /// Frame's side: a lower triangle L and u_0 of all gripped unknowns, and where they were held in
  /// that solution (empty: at u_0). Values that are not finite are not published, nor those of
  /// other grips than described. Throws UsageError where sizes do not fit.
  void publish(const Eigen::Ref<const Eigen::MatrixXd>& l,
               const Eigen::Ref<const Eigen::VectorXd>& u_0, std::span<const double> held = {});
  /// Frame's side: grips of a host that what is published from now on holds, and which unknowns of
  /// the scene's grips, as places below size(), ascending. Before the first call all of these.
  void describe(std::vector<HeldGrip> grips, std::vector<Index> own);
  /// Frame's side: step that what is published from now on belongs to.
  void label(int step) { step_ = step; }
  /// Frame's side: a grip is let go; the last solution goes on without it at once.
  void let_go(int grip);
  /// Frame's side: the same of the scene's; `own`: what they hold from now on, as in describe().
  void let_go(std::vector<Index> own);
  /// Frame's side: there is no solution any more; a blend ends too.
  void withdraw();
  /// Frame's side: the last solution once more, by the grips described since, where they fit.
  void publish_again();
  /// From now on it answers FeltState::gone. From any thread.
  void end() { gone_.store(true, std::memory_order_release); }

  /// Frame's side: while it lives nothing is handed over; then the last solution is, where it is
  /// another one. For solutions on the way to a state.
  class Quiet {
   public:
    explicit Quiet(InstrumentForces* forces);
    ~Quiet();
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;

   private:
    InstrumentForces* forces_;  // null: nobody asks
  };

  /// From any thread: where the solution changes, forces go from those of the one before to those
  /// of the new one within so many milliseconds, by both maps at the present displacement; 0 (the
  /// default): at once. A grip that is let go has no force at once; one newly held comes from none.
  void blend(double ms) { blend_ms_.store(ms, std::memory_order_relaxed); }

  /// Instruments' side: forces [N] on the body for displacements [mm] of the unknowns that the
  /// scene's grips hold, in the order of Problem::gripped_dofs(); a host's grips hold still. Of one
  /// that has let go the displacement is not read and the force is 0.
  /// Returns false, with zeros, before the first frame, for displacements that are not finite and
  /// once the simulation is gone. Allocates nothing. Cost g^2 multiply-adds, twice that while it
  /// blends.
  bool forces(std::span<const double> displacements, std::span<double> forces);
  /// The same with hands that move grips of a host; those not named hold still where the solution
  /// has them, and so do the scene's where `displacements` and `forces` are empty. `now`: the time
  /// that age and blend go by, never before that of an earlier call.
  Felt feel(std::span<const double> displacements, std::span<double> forces, std::span<Hand> hands,
            Clock::time_point now = Clock::now());

  /// Gripped unknowns of the scene's grips.
  [[nodiscard]] Index size() const { return size_; }
  /// Solutions published.
  [[nodiscard]] std::uint64_t frames() const { return frames_.load(std::memory_order_relaxed); }

 private:
  struct Held {
    std::vector<HeldGrip> grips;
    std::vector<Index> own;
  };
  using Grips = std::shared_ptr<const Held>;
  struct Solution {
    Eigen::MatrixXd l;
    Eigen::VectorXd u_0, held;
    Grips grips;
    std::uint64_t number = 0;
    int step = kNone;
    Clock::time_point found;
    bool filled = false;
  };
  /// With the reading side's room.
  struct Copy {
    Solution of;
    Eigen::VectorXd d, h, jump;
  };

  void hand_over();
  [[nodiscard]] bool fits(const Solution& solution) const;
  [[nodiscard]] std::size_t own_of(const Solution& solution) const;
  [[nodiscard]] Index own_place(const Solution& solution, std::size_t i) const;
  void keep_rows(const std::vector<Eigen::Index>& rows, Held left);
  [[nodiscard]] const HeldGrip* find(const Copy& copy, int grip) const;
  [[nodiscard]] bool evaluate(Copy& copy, std::span<const double> displacements,
                              std::span<const Hand> hands) const;
  void add_before(Copy& now, const Copy& before, double share, bool with_jump) const;
  [[nodiscard]] double share(Clock::time_point now) const;
  [[nodiscard]] bool take_news(std::span<const double> displacements, std::span<const Hand> hands,
                               Clock::time_point now);
  [[nodiscard]] bool answer(std::span<const double> displacements, std::span<const Hand> hands,
                            Clock::time_point now);
  void tell(Hand& hand) const;

  Index size_;
  Eigen::VectorXd anchors_;
  // Frame's side.
  Solution last_;
  Grips grips_;
  int step_ = kNone, quiet_ = 0;
  bool waits_ = false;  // something is to be handed over after the quiet
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<bool> gone_{false};
  std::atomic<double> blend_ms_{0};
  mutable Handover<Copy, 2> handover_;
  // Instruments' side.
  Clock::time_point since_{};  // the solution was first seen
  bool blends_ = false;        // the one before it can be blended in
};

}  // namespace sunder
