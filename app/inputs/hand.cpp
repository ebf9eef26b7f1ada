// SPDX-License-Identifier: Apache-2.0
#include "app/inputs/hand.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

/// Elements that an action has taken out, from the rows that it added.
std::vector<Index> taken_out(const Simulation& simulation, std::size_t rows_before) {
  std::vector<Index> elements;
  const auto& rows = simulation.destroyed();
  for (std::size_t i = rows_before; i < rows.size(); ++i) {
    if (rows[i].cause == Cause::script) elements.push_back(rows[i].element);
  }
  return elements;
}

}  // namespace

Hand::Hand(Simulation& simulation, bool goes_back) : simulation_(simulation) {
  if (goes_back) start_ = simulation.save();
}

/// A deed is taken down even where it has failed, as the simulation's history does.
template <class What, class Do>
void Hand::act(What what, Do&& act) {
  const int undos = simulation_.undos();
  const auto take_down = [&] {
    done_.push_back({std::move(what), simulation_.undos() > undos});
    undone_.clear();
  };
  try {
    act();
  } catch (const NumericalError&) {
    take_down();
    throw;
  }
  take_down();
}

Vec3 Hand::value(std::size_t instrument) const {
  for (auto deed = done_.rbegin(); deed != done_.rend(); ++deed) {
    const auto* drive = std::get_if<input::Drive>(&deed->what);
    if (drive && drive->index == instrument) return drive->value;
  }
  const Scene& scene = simulation_.problem().scene();
  const Instrument& tool = scene.instruments[instrument];
  const double time = static_cast<double>(simulation_.steps_done()) / scene.steps;
  const double factor = simulation_.steps_done() > 0 ? tool.factor(time) : 0.0;
  if (const auto* grip = std::get_if<Grip>(&tool.action)) return factor * grip->displacement;
  if (const auto* pull = std::get_if<Pull>(&tool.action)) return factor * pull->force;
  return factor * std::get<Press>(tool.action).force;
}

void Hand::drive(const input::Drive& drive) {
  input::Drive whole = drive;
  if (drive.further) whole.value += value(drive.index);
  whole.further = false;
  act(whole, [&] { simulation_.drive(whole.index, whole.value); });
}

void Hand::turn(const input::Turn& turn) {
  act(turn, [&] { simulation_.turn(turn.index, turn.rotation); });
}

void Hand::remove(std::span<const Index> elements) {
  if (elements.empty()) return;
  act(input::Remove{{elements.begin(), elements.end()}}, [&] { simulation_.remove(elements); });
}

int Hand::grasp(const input::Grasp& grasp) {
  input::Grasp held = grasp;
  const int undos = simulation_.undos();
  held.grip = grasp.nodes.empty() ? simulation_.grasp(grasp.near, grasp.radius, grasp.rigid)
                                  : simulation_.grasp(grasp.nodes, grasp.rigid);
  done_.push_back({held, simulation_.undos() > undos});
  undone_.clear();
  return held.grip;
}

void Hand::pose(const input::Pose& pose) {
  act(pose, [&] { simulation_.pose(pose.grip, {pose.position, pose.quaternion}); });
}

void Hand::release(int grip) {
  act(input::Release{grip}, [&] { simulation_.release(grip); });
}

std::vector<int> Hand::grips() const {
  std::vector<int> grips;
  for (const Deed& deed : done_) {
    if (const auto* grasp = std::get_if<input::Grasp>(&deed.what)) grips.push_back(grasp->grip);
    if (const auto* release = std::get_if<input::Release>(&deed.what)) {
      std::erase(grips, release->grip);
    }
  }
  return grips;
}

int Hand::cut(const input::Cut& cut) {
  const auto swept = swept_by(cut);
  const std::size_t rows = simulation_.destroyed().size();
  const int undos = simulation_.undos();
  const auto take_down = [&] {
    if (simulation_.destroyed().size() == rows) return;  // beside the body
    const bool broke = simulation_.undos() > undos;
    if (simulation_.backend().needs().split) {
      done_.push_back({cut, broke});
    } else {
      done_.push_back({input::Remove{taken_out(simulation_, rows)}, broke});
    }
    undone_.clear();
  };
  int count = 0;
  try {
    count = simulation_.cut(swept);
  } catch (const NumericalError&) {
    take_down();
    throw;
  }
  take_down();
  return count;
}

StepReport Hand::step() {
  StepReport report;
  act(input::Step{}, [&] { report = simulation_.step(); });
  return report;
}

void Hand::undo(int count) {
  simulation_.undo(count);
  auto from = done_.end();
  for (int left = count; left > 0 && from != done_.begin();) {
    --from;
    if (from->broke) --left;
  }
  undone_.insert(undone_.begin(), std::make_move_iterator(from),
                 std::make_move_iterator(done_.end()));
  done_.erase(from, done_.end());
}

void Hand::redo(int count) {
  simulation_.redo(count);
  auto to = undone_.begin();
  for (int left = count; to != undone_.end(); ++to) {
    if (to->broke && left-- == 0) break;
  }
  done_.insert(done_.end(), std::make_move_iterator(undone_.begin()), std::make_move_iterator(to));
  undone_.erase(undone_.begin(), to);
}

void Hand::reset() {
  simulation_.restore(start_);
  done_.clear();
  undone_.clear();
}

std::string Hand::recording() const {
  std::string text;
  int steps = 0;
  const auto write_steps = [&] {
    if (steps > 0) text += text_of(input::Step{steps}) + "\n";
    steps = 0;
  };
  for (const Deed& deed : done_) {
    if (std::holds_alternative<input::Step>(deed.what)) {
      ++steps;
      continue;
    }
    write_steps();
    std::visit([&](const auto& what) { text += text_of(what) + "\n"; }, deed.what);
  }
  write_steps();
  return text;
}

std::vector<std::array<Vec3, 3>> swept_by(const input::Cut& cut) {
  std::vector<std::array<Vec3, 3>> swept;
  for (std::size_t i = 0; i + 3 < cut.edge.size(); i += 2) {
    swept.push_back({cut.edge[i], cut.edge[i + 1], cut.edge[i + 3]});
    swept.push_back({cut.edge[i], cut.edge[i + 3], cut.edge[i + 2]});
  }
  return swept;
}

bool do_to_body(Hand& hand, const Inputs& inputs, const Input& input) {
  try {
    if (const auto* drive = std::get_if<input::Drive>(&input.what)) {
      hand.drive(*drive);
    } else if (const auto* turn = std::get_if<input::Turn>(&input.what)) {
      hand.turn(*turn);
    } else if (const auto* remove = std::get_if<input::Remove>(&input.what)) {
      hand.remove(remove->elements);
    } else if (const auto* grasp = std::get_if<input::Grasp>(&input.what)) {
      hand.grasp(*grasp);
    } else if (const auto* pose = std::get_if<input::Pose>(&input.what)) {
      hand.pose(*pose);
    } else if (const auto* release = std::get_if<input::Release>(&input.what)) {
      hand.release(release->grip);
    } else if (const auto* cut = std::get_if<input::Cut>(&input.what)) {
      hand.cut(*cut);
    } else {
      return false;
    }
  } catch (const UsageError& error) {
    throw InputError(InputFault::out_of_range, inputs.at(input) + error.what());
  }
  return true;
}

Replay::Replay(const Inputs& inputs, Hand& hand, int steps) : inputs_(inputs), hand_(hand) {
  long long asked = 0;
  const auto refuse = [&](const Input& input, const std::string& what) {
    throw InputError(InputFault::out_of_range,
                     inputs.at(input) + what +
                         " is for sunder view: a run goes forward and sees nothing; take the "
                         "recording that view leaves");
  };
  for (const Input& i : inputs.list) {
    if (std::holds_alternative<input::Undo>(i.what)) refuse(i, "undo");
    if (std::holds_alternative<input::Redo>(i.what)) refuse(i, "redo");
    if (std::holds_alternative<input::Reset>(i.what)) refuse(i, "reset");
    if (std::holds_alternative<input::Pause>(i.what)) refuse(i, "pause, or go,");
    if (std::holds_alternative<input::Stroke>(i.what)) refuse(i, "stroke");
    if (const auto* step = std::get_if<input::Step>(&i.what)) asked += step->count;
    if (const auto* frame = std::get_if<input::Frame>(&i.what)) asked += frame->count;
    if (asked <= steps) continue;
    throw InputError(InputFault::out_of_range,
                     inputs.at(i) + "here the inputs come to " + std::to_string(asked) +
                         " steps; the scene has " + std::to_string(steps) +
                         ": raise time.steps, or leave steps out");
  }
}

bool Replay::reach_step() {
  while (steps_ == 0 && next_ < inputs_.list.size()) {
    const Input& input = inputs_.list[next_++];
    if (const auto* step = std::get_if<input::Step>(&input.what)) steps_ = step->count;
    if (const auto* frame = std::get_if<input::Frame>(&input.what)) steps_ = frame->count;
    static_cast<void>(do_to_body(hand_, inputs_, input));
  }
  if (steps_ == 0) return false;
  --steps_;
  return true;
}

}  // namespace sunder::app
