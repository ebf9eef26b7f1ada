// SPDX-License-Identifier: Apache-2.0
// Loads that span what a scene's instruments and a host's tools can do, to be known beforehand.
#include <algorithm>
#include <cmath>

#include "frame/loads.hpp"

namespace sunder {
namespace {

constexpr std::size_t kMostKnown = 12;  // that a solver remembers (core/solver/checked_loads.hpp)

/// Copies of a load with nothing on it, each with one direction more.
class LoadSpan {
 public:
  explicit LoadSpan(Load none) : none_(std::move(none)) {}

  /// A force of 1 N in equal parts on nodes along an axis.
  void add_force(const Problem& problem, std::span<const Index> nodes, int axis) {
    Load load = none_;
    for (Index n : nodes) {
      const auto at = std::ranges::lower_bound(load.force_dofs, problem.dof(n, axis));
      if (at == load.force_dofs.end() || *at != problem.dof(n, axis)) continue;  // a support's
      load.forces[static_cast<std::size_t>(at - load.force_dofs.begin())] +=
          1 / static_cast<double>(nodes.size());
    }
    add(std::move(load));
  }
  /// `moved(g)`: displacement of gripped unknown g [mm].
  template <class Moved>
  void add_displacement(Moved&& moved) {
    Load load = none_;
    for (std::size_t g = 0; g < load.displacements.size(); ++g) load.displacements[g] = moved(g);
    add(std::move(load));
  }
  void add(Load load) {
    const auto acts = [](double v) { return v != 0; };
    const auto moves = [](double v) { return std::abs(v) > 1e-9; };  // mm; arms that are rounding
    if (loads_.size() + 1 > kMostKnown || (std::ranges::none_of(load.forces, acts) &&
                                           std::ranges::none_of(load.displacements, moves))) {
      return;
    }
    loads_.push_back(std::move(load));
  }
  [[nodiscard]] std::vector<Load>& loads() { return loads_; }

 private:
  Load none_;
  std::vector<Load> loads_;
};

}  // namespace

/// On the unknowns of one, which is the first.
std::vector<Load> Loads::span_on(const Load& first) const {
  const auto& instruments = problem_.scene().instruments;
  Load none = first;
  std::ranges::fill(none.forces, 0.0);
  LoadSpan span(std::move(none));
  span.add(first);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      if (std::holds_alternative<Pull>(instruments[i].action))
        span.add_force(problem_, nodes(i), axis);
      span.add_displacement([&](std::size_t g) {
        return g < gripped_.size() && gripped_[g].instrument == i && gripped_[g].axis == axis ? 1.0
                                                                                              : 0.0;
      });
    }
    for (const Tool& tool : tools_) {
      if (!tool.holds) span.add_force(problem_, tool.nodes, axis);
      span.add_displacement([&](std::size_t g) {
        const bool of_it = tool.holds && g >= tool.first && g < tool.first + 3 * tool.nodes.size();
        return of_it && (g - tool.first) % 3 == static_cast<std::size_t>(axis) ? 1.0 : 0.0;
      });
    }
  }
  // A turn's matrix, entry by entry: a finite turn is no sum of small ones.
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (std::size_t i = 0; i < instruments.size(); ++i) {
        span.add_displacement([&](std::size_t g) {
          if (g >= gripped_.size() || gripped_[g].instrument != i) return 0.0;
          return gripped_[g].axis == row ? gripped_[g].arm[column] : 0.0;
        });
      }
      for (const Tool& tool : tools_) {
        span.add_displacement([&](std::size_t g) {
          if (!tool.rigid || g < tool.first || g >= tool.first + 3 * tool.nodes.size()) return 0.0;
          const std::size_t at = g - tool.first;
          return at % 3 == static_cast<std::size_t>(row) ? tool.arms[at / 3][column] : 0.0;
        });
      }
    }
  }
  return std::move(span.loads());
}

std::vector<Load> Loads::span(double time) {
  const auto& instruments = problem_.scene().instruments;
  const auto pulls = [&](std::size_t i) {
    return std::holds_alternative<Pull>(instruments[i].action);
  };
  // The unknowns of all of them, as one load.
  shares_.clear();
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    if (pulls(i)) add(nodes(i), Vec3::Ones());
  }
  for (const Tool& tool : tools_) {
    if (!tool.holds) add(tool.nodes, Vec3::Ones());
  }
  Load weight;
  sum_into(weight);
  std::ranges::fill(weight.forces, 0.0);
  weight.displacements.assign(gripped_.size(), 0.0);
  for (const Tool& tool : tools_) {
    if (tool.holds)
      weight.displacements.resize(weight.displacements.size() + 3 * tool.nodes.size());
  }
  if (weight_) weight_->add_intact(weight);
  const State now = state();
  std::ranges::fill(driven_, std::nullopt);
  std::ranges::fill(turned_, std::nullopt);
  expand(time);
  driven_ = now.driven;
  turned_ = now.turned;
  std::ranges::fill(forces_, Vec3::Zero());  // nothing acts before the first step
  // A solver knows loads by their unknowns: forces along some axes alone are another kind.
  std::vector<Load> loads = span_on(weight);
  if (expansion_.force_dofs != weight.force_dofs) {
    Load own = expansion_;
    std::ranges::fill(own.forces, 0.0);
    std::ranges::fill(own.displacements, 0.0);
    if (weight_) weight_->add_intact(own);
    for (Load& load : span_on(std::move(own))) loads.push_back(std::move(load));
  }
  loads.push_back(expansion_);
  return loads;
}

}  // namespace sunder
