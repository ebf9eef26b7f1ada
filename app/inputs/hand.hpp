// SPDX-License-Identifier: Apache-2.0
// What is done to a simulation, and the record of it: inputs that, done again in a run of the same
// scene, lead to the same bits.
#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "app/inputs/inputs.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {

/// All that is done to the simulation must be done by it. Throws what Simulation throws.
class Hand {
 public:
  /// `goes_back`: undo(), redo() and reset() are wanted, and the simulation keeps a history
  /// (Simulation::keep_history). It must outlive this, and has not been stepped.
  Hand(Simulation& simulation, bool goes_back);

  void drive(const input::Drive& drive);
  void turn(const input::Turn& turn);
  void remove(std::span<const Index> elements);
  /// Returns the grip's number.
  int grasp(const input::Grasp& grasp);
  void pose(const input::Pose& pose);
  void release(int grip);
  /// Grips that hold now, in the order in which they took hold.
  [[nodiscard]] std::vector<int> grips() const;
  /// How a grip holds on.
  struct Held {
    int grip = kNone;
    bool rigid = false;
    std::array<double, 4> quaternion{0, 0, 0, 1};  ///< as posed last
    Vec3 offset = Vec3::Zero();  ///< from its place to the mean of its nodes, as it took hold [mm]
  };
  [[nodiscard]] std::vector<Held> held() const;
  /// Returns how many elements went, or faces opened. Elements that go are recorded as such, of
  /// what a blade has opened the blade.
  int cut(const input::Cut& cut);
  StepReport step();

  void undo(int count);
  void redo(int count);
  /// Back to before the first step.
  void reset();

  /// Force [N] or displacement [mm] of an instrument as the last step had it, or as it was driven
  /// since.
  [[nodiscard]] Vec3 value(std::size_t instrument) const;
  /// Rotation vector of a rigid grip of the scene's likewise [deg].
  [[nodiscard]] Vec3 rotation(std::size_t instrument) const;
  /// Whether drive() or turn() has taken the place of what the scene says.
  [[nodiscard]] bool driven(std::size_t instrument) const { return last<input::Drive>(instrument); }
  [[nodiscard]] bool turned(std::size_t instrument) const { return last<input::Turn>(instrument); }
  /// What led here, without what was taken back: inputs (parse_inputs).
  [[nodiscard]] std::string recording() const;

 private:
  struct Deed {
    std::variant<input::Drive, input::Turn, input::Remove, input::Grasp, input::Pose,
                 input::Release, input::Cut, input::Step>
        what;
    bool broke = false;  ///< something: what undo() counts
  };
  template <class What, class Do>
  void act(What what, Do&& act);
  /// The last one of this instrument; null: there is none.
  template <class What>
  [[nodiscard]] const What* last(std::size_t instrument) const {
    for (auto deed = done_.rbegin(); deed != done_.rend(); ++deed) {
      const auto* what = std::get_if<What>(&deed->what);
      if (what && what->index == instrument) return what;
    }
    return nullptr;
  }
  [[nodiscard]] double factor(const Instrument& tool) const;

  Simulation& simulation_;
  Mark start_;
  std::map<int, Vec3> offsets_;      ///< of grips (Held::offset); numbers never come twice
  std::vector<Deed> done_, undone_;  ///< the latter in the order in which redo() does them
};

/// The triangles that a blade sweeps from each place of its edge to the next.
[[nodiscard]] std::vector<std::array<Vec3, 3>> swept_by(const input::Cut& cut);

/// Does one input to the body; true: it was one. An error of use gets the input's place.
bool do_to_body(Hand& hand, const Inputs& inputs, const Input& input);

/// Carries out inputs in a run: they go forward, and what is seen does not matter.
class Replay {
 public:
  /// Throws InputError for an input that a run cannot do, and where they have more steps than
  /// `steps`. Both must outlive it.
  Replay(const Inputs& inputs, Hand& hand, int steps);

  /// Does what comes before the next step; false: there is none.
  [[nodiscard]] bool reach_step();

 private:
  const Inputs& inputs_;
  Hand& hand_;
  std::size_t next_ = 0;
  int steps_ = 0;  ///< still to do of the input before `next_`
};

}  // namespace sunder::app
