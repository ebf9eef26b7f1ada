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

/// Of a grip's nodes, as displacement leaves them now [mm].
Vec3 middle_of(const Simulation& simulation, int grip) {
  const auto nodes = simulation.held_nodes(grip);
  const bool parted = !simulation.corners().empty();
  const std::vector<Vec3> places =
      parted ? simulation.mesh().nodes : simulation.problem().mesh().nodes;
  const std::vector<Vec3> displacement = simulation.displacement();
  Vec3 sum = Vec3::Zero();
  for (const Index n : nodes) {
    const auto at = static_cast<std::size_t>(n);
    sum += places[at] + displacement[at];
  }
  return sum / static_cast<double>(nodes.size());
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
  if (const auto* drive = last<input::Drive>(instrument)) return drive->value;
  const Instrument& tool = simulation_.problem().scene().instruments[instrument];
  if (const auto* grip = std::get_if<Grip>(&tool.action)) return factor(tool) * grip->displacement;
  if (const auto* pull = std::get_if<Pull>(&tool.action)) return factor(tool) * pull->force;
  return factor(tool) * std::get<Press>(tool.action).force;
}

Vec3 Hand::rotation(std::size_t instrument) const {
  if (const auto* turn = last<input::Turn>(instrument)) return turn->rotation;
  const Instrument& tool = simulation_.problem().scene().instruments[instrument];
  const auto* grip = std::get_if<Grip>(&tool.action);
  return grip ? Vec3(factor(tool) * grip->turn) : Vec3::Zero();
}

/// Of the scene's ramp in the last step; nothing acts before the first.
double Hand::factor(const Instrument& tool) const {
  if (simulation_.steps_done() == 0) return 0;
  return tool.factor(static_cast<double>(simulation_.steps_done()) /
                     simulation_.problem().scene().steps);
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
  offsets_[held.grip] = middle_of(simulation_, held.grip) - simulation_.centre_of(held.grip);
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

std::vector<Hand::Held> Hand::held() const {
  std::vector<Held> all;
  for (const Deed& deed : done_) {
    if (const auto* grasp = std::get_if<input::Grasp>(&deed.what)) {
      all.push_back(
          {grasp->grip, grasp->rigid, input::Pose().quaternion, offsets_.at(grasp->grip)});
    } else if (const auto* pose = std::get_if<input::Pose>(&deed.what)) {
      for (Held& held : all) {
        if (held.grip == pose->grip) held.quaternion = pose->quaternion;
      }
    } else if (const auto* release = std::get_if<input::Release>(&deed.what)) {
      std::erase_if(all, [&](const Held& held) { return held.grip == release->grip; });
    }
  }
  return all;
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
    if (std::holds_alternative<input::Set>(i.what)) refuse(i, "set");
    if (std::holds_alternative<input::Open>(i.what)) refuse(i, "open");
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
