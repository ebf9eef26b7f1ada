// SPDX-License-Identifier: Apache-2.0
#include "frame/loads.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sunder {
namespace {

bool is_press(const Instrument& instrument) {
  return std::holds_alternative<Press>(instrument.action);
}

Vec3 centroid(const Mesh& mesh, std::span<const Index> nodes) {
  Vec3 sum = Vec3::Zero();
  for (Index n : nodes) sum += mesh.nodes[n];
  return sum / static_cast<double>(nodes.size());
}

/// R - I of a rotation vector [deg], by Rodrigues' formula.
Mat3 turn_of(const Vec3& degrees) {
  const double angle = degrees.norm() * std::numbers::pi / 180;
  if (angle == 0) return Mat3::Zero();
  const Vec3 n = degrees.normalized();
  Mat3 cross;
  cross << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
  const double half = std::sin(angle / 2);
  return std::sin(angle) * cross + 2 * half * half * cross * cross;
}

}  // namespace

Loads::Loads(const Problem& problem) : problem_(problem) {
  const auto& instruments = problem.scene().instruments;
  if (std::any_of(instruments.begin(), instruments.end(), is_press)) {
    elements_of_node_.emplace(problem.mesh());
  }
  if (!problem.moves() && !problem.scene().gravity.isZero(0)) weight_.emplace(problem);
  pressed_.resize(instruments.size());
  forces_.assign(instruments.size(), Vec3::Zero());
  driven_.resize(instruments.size());
  turned_.resize(instruments.size());
  turn_.assign(instruments.size(), Mat3::Zero());
  let_go_.assign(instruments.size(), 0);
  next_tool_ = static_cast<int>(instruments.size());
  find_gripped();
  reserve();
}

/// What the scene's grips hold, by ascending unknowns.
void Loads::find_gripped() {
  const auto& instruments = problem_.scene().instruments;
  std::vector<std::pair<Index, Gripped>> found;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    if (!grip || let_go_[i]) continue;
    const auto& nodes = problem_.instrument_nodes()[i].nodes;
    const Vec3 centre = grip->rigid ? centroid(problem_.mesh(), nodes) : Vec3::Zero();
    for (Index n : nodes) {
      const Vec3 arm = grip->rigid ? Vec3(problem_.mesh().nodes[n] - centre) : Vec3::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        if (grip->axes.has(axis)) found.push_back({problem_.dof(n, axis), {i, n, axis, arm}});
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  gripped_.clear();
  held_unknowns_.clear();
  for (const auto& [dof, of] : found) {
    gripped_.push_back(of);
    held_unknowns_.push_back(dof);
  }
  expansion_.displacements.assign(gripped_.size(), 0.0);
}

std::vector<Index> Loads::let_go(std::size_t instrument) {
  std::vector<Index> unknowns;
  for (std::size_t g = 0; g < gripped_.size(); ++g) {
    if (gripped_[g].instrument == instrument) unknowns.push_back(held_unknowns_[g]);
  }
  let_go_[instrument] = 1;
  find_gripped();
  tools_changed();
  return unknowns;
}

void Loads::restore(const State& state) {
  pressed_ = state.pressed;
  driven_ = state.driven;
  turned_ = state.turned;
  if (let_go_ != state.let_go) {
    let_go_ = state.let_go;
    find_gripped();
  }
  tools_ = state.tools;
  next_tool_ = state.next_tool;
  tools_changed();
  std::ranges::fill(forces_, Vec3::Zero());
  acting_.clear();
}

int Loads::take(Tool tool) {
  tool.id = next_tool_++;
  tools_.push_back(std::move(tool));
  tools_changed();
  return tools_.back().id;
}

void Loads::drop(int id) {
  std::erase_if(tools_, [id](const Tool& tool) { return tool.id == id; });
  tools_changed();
}

void Loads::move(int id, std::span<const Index> nodes, const Vec3& force) {
  Tool& push = *tool(id);
  push.nodes.assign(nodes.begin(), nodes.end());
  push.force = force;
  tools_changed();
}

void Loads::solved() {
  for (Tool& tool : tools_) tool.turn_at_load = tool.turn;
}

Tool* Loads::tool(int id) {
  const auto found = std::ranges::find(tools_, id, &Tool::id);
  return found == tools_.end() ? nullptr : &*found;
}

std::vector<Index> Loads::held_nodes() const {
  std::vector<Index> nodes;
  for (const Tool& tool : tools_) {
    if (tool.holds) nodes.insert(nodes.end(), tool.nodes.begin(), tool.nodes.end());
  }
  return nodes;
}

void Loads::tools_changed() {
  std::size_t grips = gripped_.size();
  for (Tool& tool : tools_) {
    tool.first = grips;
    if (tool.holds) grips += 3 * tool.nodes.size();
  }
  if (weight_) weight_->hold(held_unknowns_, held_nodes());
  reserve();
}

/// Whatever acts at a time, a frame allocates nothing.
void Loads::reserve() {
  constexpr std::size_t kPressed = std::tuple_size_v<decltype(PressedNodes::nodes)>;
  std::size_t shares = weight_ ? static_cast<std::size_t>(problem_.dof_count()) : 0;
  for (const InstrumentNodes& i : problem_.instrument_nodes())
    shares += 3 * std::max(i.nodes.size(), kPressed);
  std::size_t grips = gripped_.size();
  for (const Tool& tool : tools_) (tool.holds ? grips : shares) += 3 * tool.nodes.size();
  for (auto& pressed : pressed_) pressed.reserve(kPressed);
  acting_.reserve(pressed_.size());
  shares_.reserve(shares);
  sorted_.reserve(shares);
  for (Load* load : {&all_, &expansion_}) {
    load->force_dofs.reserve(shares);
    load->forces.reserve(shares);
    load->displacements.reserve(grips);
  }
}

std::span<const Index> Loads::nodes(std::size_t instrument) const {
  return is_press(problem_.scene().instruments[instrument])
             ? pressed_[instrument]
             : problem_.instrument_nodes()[instrument].nodes;
}

void Loads::choose_pressed_nodes(std::size_t instrument, const FractureCriterion& criterion,
                                 std::span<const std::uint8_t> destroyed,
                                 std::vector<Finding>& findings) {
  std::vector<Index>& chosen = pressed_[instrument];
  const bool keep = !chosen.empty() && std::all_of(chosen.begin(), chosen.end(), [&](Index n) {
    const auto around = elements_of_node_->of(n);
    return std::any_of(around.begin(), around.end(), [&](Index e) { return !destroyed[e]; });
  });
  if (keep) return;
  const Instrument& tool = problem_.scene().instruments[instrument];
  const PressedNodes found = criterion.pressed_nodes(std::get<Press>(tool.action), destroyed);
  chosen.assign(found.list().begin(), found.list().end());
  if (chosen.empty()) {
    findings.push_back({Finding::Kind::nothing_to_press, static_cast<int>(instrument)});
  }
}

Vec3 Loads::value(std::size_t instrument, double time) const {
  if (driven_[instrument]) return *driven_[instrument];
  const Instrument& tool = problem_.scene().instruments[instrument];
  const double factor = tool.factor(time);
  if (const auto* grip = std::get_if<Grip>(&tool.action)) return factor * grip->displacement;
  if (const auto* pull = std::get_if<Pull>(&tool.action)) return factor * pull->force;
  return factor * std::get<Press>(tool.action).force;
}

void Loads::add(std::span<const Index> on, const Vec3& force) {
  for (Index n : on) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      const double share = force[axis] / static_cast<double>(on.size());
      if (d == kNone || share == 0) continue;
      shares_.push_back({d, static_cast<int>(shares_.size()), share});
    }
  }
}

Vec3 Loads::force_on_supports() const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    if (!forces_[i].isZero(0)) sum += on_supports(nodes(i), forces_[i]);
  }
  for (const Tool& tool : tools_) {
    if (!tool.holds) sum += on_supports(tool.nodes, tool.force);
  }
  for (Index n = 0; weight_ && n < problem_.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (problem_.dof(n, axis) == kNone) sum[axis] += weight_->of(n, axis);
    }
  }
  return sum;
}

/// What of a force in equal parts acts on axes that supports hold.
Vec3 Loads::on_supports(std::span<const Index> on, const Vec3& force) const {
  Vec3 sum = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto held = std::count_if(on.begin(), on.end(),
                                    [&](Index n) { return problem_.dof(n, axis) == kNone; });
    if (held > 0)
      sum[axis] += force[axis] * static_cast<double>(held) / static_cast<double>(on.size());
  }
  return sum;
}

double Loads::weight_on_grip(std::size_t g) const {
  return weight_ ? weight_->of(gripped_[g].node, gripped_[g].axis) : 0;
}

void Loads::sum_into(Load& load) {
  sorted_ = shares_;
  std::sort(sorted_.begin(), sorted_.end(), [](const Share& a, const Share& b) {
    return a.dof != b.dof ? a.dof < b.dof : a.order < b.order;
  });
  load.force_dofs.clear();
  load.forces.clear();
  for (const Share& s : sorted_) {
    if (!load.force_dofs.empty() && load.force_dofs.back() == s.dof) {
      load.forces.back() += s.force;
    } else {
      load.force_dofs.push_back(s.dof);
      load.forces.push_back(s.force);
    }
  }
}

void Loads::take_turns(double time) {
  for (std::size_t i = 0; i < turn_.size(); ++i) {
    const Instrument& tool = problem_.scene().instruments[i];
    const auto* grip = std::get_if<Grip>(&tool.action);
    if (!grip || !grip->rigid) continue;
    turn_[i] = turn_of(turned_[i].value_or(tool.factor(time) * grip->turn));
  }
}

/// All but the pressing instruments.
void Loads::expand(double time) {
  const auto& instruments = problem_.scene().instruments;
  shares_.clear();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    if (!std::holds_alternative<Pull>(instruments[i].action)) continue;
    forces_[i] = value(i, time);
    add(nodes(i), forces_[i]);
  }
  for (const Tool& tool : tools_) {
    if (!tool.holds) add(tool.nodes, tool.force);
  }
  sum_into(expansion_);
  if (weight_) weight_->add_intact(expansion_);
  take_turns(time);
  expansion_.displacements.resize(gripped_.size());
  for (std::size_t g = 0; g < gripped_.size(); ++g) {
    const auto& [instrument, node, axis, arm] = gripped_[g];
    double& moved = expansion_.displacements[g];
    moved = value(instrument, time)[axis];
    if (!turn_[instrument].isZero(0)) moved += turn_[instrument].row(axis).dot(arm);
  }
  for (const Tool& tool : tools_) {
    for (std::size_t n = 0; tool.holds && n < tool.nodes.size(); ++n) {
      const Vec3 moved = tool.displacement(n);
      expansion_.displacements.insert(expansion_.displacements.end(), moved.data(),
                                      moved.data() + 3);
    }
  }
}

void Loads::update(double time, const FractureCriterion& criterion,
                   std::span<const std::uint8_t> destroyed, std::vector<Finding>& findings) {
  const auto& instruments = problem_.scene().instruments;
  acting_.clear();
  expand(time);
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* press = std::get_if<Press>(&instruments[i].action);
    if (!press) continue;
    forces_[i].setZero();
    const bool idle = driven_[i] ? driven_[i]->isZero(0) : instruments[i].factor(time) == 0;
    if (idle) continue;
    choose_pressed_nodes(i, criterion, destroyed, findings);
    if (pressed_[i].empty()) continue;
    forces_[i] = value(i, time);
    add(pressed_[i], forces_[i]);
    acting_.push_back({i, press, forces_[i], pressed_[i]});
  }
  sum_into(all_);
  if (weight_) {
    weight_->look(destroyed);
    weight_->add_present(all_);
  }
  all_.displacements = expansion_.displacements;
}

}  // namespace sunder
