// SPDX-License-Identifier: Apache-2.0
// What a host told a simulation to do, in order, and states on the way. Done again on a fresh
// simulation, the actions give the same bits: neither the clock nor an observer decides then.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "fracture/criterion.hpp"
#include "frame/loads.hpp"
#include "sunder/simulation.hpp"

namespace sunder {

namespace action {
struct Drive {
  std::size_t instrument = 0;
  Vec3 value;
};
struct Turn {
  std::size_t instrument = 0;
  Vec3 rotation;
};
struct Attribute {
  bool wanted = false;
};
struct Velocity {
  std::vector<Vec3> velocity;
};
struct Step {
  std::optional<double> dt;  // as it was asked for
  int events = kNone;        // that ended it, by observers or by time; none: it ended by itself
  bool by_time = false;
};
struct Remove {
  std::vector<Index> elements;
};
struct Open {
  std::vector<fracture::PassedFace> faces;
};
struct Grasp {
  std::vector<Index> nodes;
  bool rigid = false;
  Vec3 centre = Vec3::Zero();  // where it takes hold [mm]
};
struct Pose {
  int id = 0;
  Vec3 position = Vec3::Zero();
  std::array<double, 4> quaternion{};  // as it was given
};
struct Release {
  int id = 0;
};
struct Push {
  std::vector<Index> nodes;
  Vec3 force = Vec3::Zero();
};
struct Move {
  int id = 0;
  std::vector<Index> nodes;
  Vec3 force = Vec3::Zero();
};
struct Drop {
  int id = 0;
};
struct WarmUp {};
}  // namespace action

struct Action {
  using Drive = action::Drive;
  using Turn = action::Turn;
  using Attribute = action::Attribute;
  using Velocity = action::Velocity;
  using Step = action::Step;
  using Remove = action::Remove;
  using Grasp = action::Grasp;
  using Pose = action::Pose;
  using Release = action::Release;
  using Push = action::Push;
  using Move = action::Move;
  using Drop = action::Drop;
  using Open = action::Open;
  using WarmUp = action::WarmUp;
  std::variant<Drive, Turn, Attribute, Velocity, Step, Remove, Grasp, Pose, Release, Push, Move,
               Drop, Open, WarmUp>
      what;
  bool failed = false;  // with a NumericalError
  bool broke = false;   // something, or a grip or a push came or went: undo() stops before it

  /// Whether a grip or a push comes or goes.
  [[nodiscard]] bool of_tools() const {
    return std::holds_alternative<Grasp>(what) || std::holds_alternative<Release>(what) ||
           std::holds_alternative<Push>(what) || std::holds_alternative<Drop>(what);
  }
  /// Whether it may be one that undo() stops before.
  [[nodiscard]] bool undoable() const {
    return of_tools() || std::holds_alternative<Step>(what) ||
           std::holds_alternative<Remove>(what) || std::holds_alternative<Open>(what);
  }
};

/// A state that the backend can go back to by itself.
struct Simulation::Kept {
  std::shared_ptr<const BackendState> backend;
  std::shared_ptr<const CriterionState> criterion;
  Loads::State loads;
  std::vector<std::uint8_t> averaged;  // empty: strength is judged by element
  Now now;
  std::size_t destroyed = 0, findings = 0;
};

/// An action that has been done is at one place in one past alone: the same pointer, the same past.
struct MarkedState {
  std::shared_ptr<const int> owner;
  Simulation::Actions actions;
  std::shared_ptr<const Simulation::Kept> kept;  // null: the backend keeps none
  int events = 0;                                // of the run so far
};

struct Simulation::History {
  /// Before an action in which something broke.
  struct Point {
    std::size_t actions = 0;
    std::shared_ptr<const Kept> kept;
    int events = 0;
  };
  MakeBackend make;
  std::size_t quick = 0;
  Actions done, undone;
  std::vector<Point> points;
  std::shared_ptr<const int> self = std::make_shared<const int>(0);  // owner of the marks
  const Action* again = nullptr;                                     // that is being done
  bool travels = false;          // what is done was done before: nobody watches, and `undone` stays
  Actions recording;             // that is played
  std::size_t played = 0;        // of it
  std::size_t undone_broke = 0;  // of `undone`: how many actions in which something broke
};

}  // namespace sunder
