// SPDX-License-Identifier: Apache-2.0
#include "loads.hpp"

#include <algorithm>

#include "sunder/in_quotes.hpp"

namespace sunder {
namespace {

using Entries = std::vector<std::pair<Index, double>>;

void fill(Load& load, Entries& entries) {
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  load.force_dofs.clear();
  load.forces.clear();
  for (const auto& [dof, force] : entries) {
    if (!load.force_dofs.empty() && load.force_dofs.back() == dof) {
      load.forces.back() += force;
    } else {
      load.force_dofs.push_back(dof);
      load.forces.push_back(force);
    }
  }
}

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

void Loads::add(std::size_t instrument, Entries& entries) const {
  const auto on = nodes(instrument);
  for (Index n : on) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      const double share = forces_[instrument][axis] / static_cast<double>(on.size());
      if (d != kNone && share != 0) entries.emplace_back(d, share);
    }
  }
}

std::vector<std::string> Loads::update(double time, const FractureCriterion& criterion,
                                       std::span<const std::uint8_t> destroyed) {
  std::vector<std::string> findings;
  const auto& instruments = problem_.scene().instruments;
  Entries entries;
  acting_.clear();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    if (!std::holds_alternative<Pull>(instruments[i].action)) continue;
    forces_[i] = value(i, time);
    add(i, entries);
  }
  fill(expansion_, entries);
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
    add(i, entries);
    acting_.push_back({i, press, forces_[i], pressed_[i]});
  }
  fill(all_, entries);
  all_.displacements = expansion_.displacements;
  return findings;
}

}  // namespace sunder
