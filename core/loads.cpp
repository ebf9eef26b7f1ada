// SPDX-License-Identifier: Apache-2.0
#include "loads.hpp"

#include <algorithm>

#include "sunder/in_quotes.hpp"

namespace sunder {
namespace {

bool is_press(const Instrument& instrument) {
  return std::holds_alternative<Press>(instrument.action);
}

}  // namespace

Loads::Loads(const Problem& problem) : problem_(problem) {
  const auto& instruments = problem.scene().instruments;
  if (std::any_of(instruments.begin(), instruments.end(), is_press)) {
    elements_of_node_.emplace(problem.mesh());
  }
  pressed_.resize(instruments.size());
  forces_.assign(instruments.size(), Vec3::Zero());
  driven_.resize(instruments.size());
  const auto gripped = problem.gripped_dofs();
  gripped_.resize(gripped.size());
  expansion_.displacements.assign(gripped.size(), 0.0);
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* grip = std::get_if<Grip>(&instruments[i].action);
    if (!grip) continue;
    for (Index n : problem.instrument_nodes()[i].nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!grip->axes.has(axis)) continue;
        const auto it = std::lower_bound(gripped.begin(), gripped.end(), problem.dof(n, axis));
        gripped_[it - gripped.begin()] = {i, axis};
      }
    }
  }
}

std::span<const Index> Loads::nodes(std::size_t instrument) const {
  return is_press(problem_.scene().instruments[instrument])
             ? pressed_[instrument]
             : problem_.instrument_nodes()[instrument].nodes;
}

void Loads::choose_pressed_nodes(std::size_t instrument, const FractureCriterion& criterion,
                                 std::span<const std::uint8_t> destroyed,
                                 std::vector<std::string>& findings) {
  std::vector<Index>& chosen = pressed_[instrument];
  const bool keep = !chosen.empty() && std::all_of(chosen.begin(), chosen.end(), [&](Index n) {
    const auto around = elements_of_node_->of(n);
    return std::any_of(around.begin(), around.end(), [&](Index e) { return !destroyed[e]; });
  });
  if (keep) return;
  const Instrument& tool = problem_.scene().instruments[instrument];
  chosen = criterion.pressed_nodes(std::get<Press>(tool.action), destroyed);
  if (chosen.empty()) {
    findings.push_back("instrument " + in_quotes(tool.name) +
                       " finds no node of its crack's face to press on and does not act");
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

void Loads::add(std::size_t instrument) {
  const auto on = nodes(instrument);
  for (Index n : on) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      const double share = forces_[instrument][axis] / static_cast<double>(on.size());
      if (d == kNone || share == 0) continue;
      shares_.push_back({d, static_cast<int>(shares_.size()), share});
    }
  }
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

std::vector<std::string> Loads::update(double time, const FractureCriterion& criterion,
                                       std::span<const std::uint8_t> destroyed) {
  std::vector<std::string> findings;
  const auto& instruments = problem_.scene().instruments;
  shares_.clear();
  acting_.clear();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    if (!std::holds_alternative<Pull>(instruments[i].action)) continue;
    forces_[i] = value(i, time);
    add(i);
  }
  sum_into(expansion_);
  for (std::size_t g = 0; g < gripped_.size(); ++g) {
    expansion_.displacements[g] = value(gripped_[g].instrument, time)[gripped_[g].axis];
  }
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto* press = std::get_if<Press>(&instruments[i].action);
    if (!press) continue;
    forces_[i].setZero();
    const bool idle = driven_[i] ? driven_[i]->isZero(0) : instruments[i].factor(time) == 0;
    if (idle) continue;
    choose_pressed_nodes(i, criterion, destroyed, findings);
    if (pressed_[i].empty()) continue;
    forces_[i] = value(i, time);
    add(i);
    acting_.push_back({i, press, forces_[i], pressed_[i]});
  }
  sum_into(all_);
  all_.displacements = expansion_.displacements;
  return findings;
}

}  // namespace sunder
