// SPDX-License-Identifier: Apache-2.0
#include "fracture/parting_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace sunder::fracture {
namespace {

/// What a pair releases is at least what it holds; and a mesh on which it is more than this many
/// times that resolves nothing of the interface.
constexpr double kMostRelease = 4;

}  // namespace

PartingPairs::PartingPairs(const Problem& problem)
    : problem_(problem), interfaces_(*problem.interfaces()) {
  now_.release.assign(interfaces_.pair_count(), 0.0);
}

Index PartingPairs::first_live(std::size_t pair, const FractureState& state) const {
  for (Index e : interfaces_.elements(pair)) {
    if (!state.destroyed[static_cast<std::size_t>(e)]) return e;
  }
  return kNone;
}

Vec3 PartingPairs::opening(std::size_t pair, const FractureState& state) const {
  const auto nodes = interfaces_.nodes(interfaces_.elements(pair).front());
  std::array<Vec3, 2> u;
  state.displacement(nodes, u);
  const auto x = [&](std::size_t i) {
    return problem_.mesh().nodes[static_cast<std::size_t>(nodes[i])] + u[i];
  };
  return x(1) - x(0);
}

/// Of the last pair: the force that it held, along the way that its nodes have gone since.
void PartingPairs::see_release(const FractureState& state) {
  Burst& burst = now_.burst;
  if (burst.last_held == 0) return;
  const std::size_t p = burst.pairs.back();
  const double release = burst.opening.dot(opening(p, state)) / burst.opening.squaredNorm();
  if (std::ranges::binary_search(burst.edge, p)) {
    burst.released += burst.last_held * (release > 1 ? std::min(release, kMostRelease) : 1.0);
  }
  burst.last_held = 0;
  kept_.reset();
}

void PartingPairs::end_burst() {
  Burst& burst = now_.burst;
  if (burst.pairs.empty()) return;
  const double release = std::clamp(burst.released / (burst.area * burst.held), 1.0, kMostRelease);
  for (std::size_t p : burst.pairs) now_.release[p] = release;
  burst = {};
  kept_.reset();
}

/// As beside it; where nothing has parted there by its law, what it holds.
double PartingPairs::expected_release(std::size_t pair) const {
  double sum = 0;
  int count = 0;
  for (std::size_t p : interfaces_.neighbours(pair)) {
    if (now_.release[p] == 0) continue;
    sum += now_.release[p];
    ++count;
  }
  return count > 0 ? sum / count : 1;
}

bool PartingPairs::at_edge(std::size_t pair, const FractureState& state) const {
  return first_live(pair, state) != kNone &&
         std::ranges::any_of(interfaces_.neighbours(pair),
                             [&](std::size_t p) { return first_live(p, state) == kNone; });
}

PartingPairs::Next PartingPairs::next(const FractureState& state, const Worst& worst) {
  see_release(state);
  Next next;
  const auto look_at = [&](std::size_t pair, double release) {
    for (Index e : interfaces_.elements(pair)) {
      if (state.destroyed[static_cast<std::size_t>(e)]) continue;
      const double ratio = interfaces_.ratio(e, state.current_stress(e)) * std::sqrt(release);
      if (ratio > next.ratio) next = {e, ratio};
    }
  };
  if (worst.element != kNone && interfaces_.has(worst.element)) {
    const std::size_t pair = interfaces_.pair(worst.element);
    look_at(pair, expected_release(pair));
  }
  for (std::size_t p = 0; p < now_.release.size(); ++p) {
    const double release = expected_release(p);
    if (release > 1) look_at(p, release);
  }
  if (!(next.ratio >= 1) && !(worst.ratio >= 1)) end_burst();
  return next;
}

void PartingPairs::add_rows(const Next& pair, const FractureState& state,
                            std::vector<DestroyedElement>& rows) const {
  const auto elements = interfaces_.elements(interfaces_.pair(pair.element));
  double most = 0;
  for (Index e : elements) {
    if (state.destroyed[static_cast<std::size_t>(e)]) continue;
    most = std::max(most, interfaces_.ratio(e, state.current_stress(e)));
  }
  for (Index e : elements) {
    if (state.destroyed[static_cast<std::size_t>(e)]) continue;
    DestroyedElement row;
    row.element = e;
    row.cause = Cause::parting;
    row.ratio = pair.ratio;
    // At the strength: what is held grows with the square of the traction.
    row.energy = most > 0 ? interfaces_.energy(e, state.current_stress(e)) / (most * most) : 0;
    rows.push_back(row);
  }
}

void PartingPairs::part(const Next& pair, const FractureState& state,
                        std::vector<DestroyedElement>& rows) {
  const std::size_t p = interfaces_.pair(pair.element);
  double held = 0, area = 0;
  for (Index e : interfaces_.elements(p)) {
    if (state.destroyed[static_cast<std::size_t>(e)]) continue;
    held += interfaces_.energy(e, state.current_stress(e));
    area += interfaces_.area(e);
  }
  Burst& burst = now_.burst;
  if (burst.pairs.empty()) {
    burst.held = held / area;
    for (std::size_t q = 0; q < now_.release.size(); ++q) {
      if (q == p || at_edge(q, state)) burst.edge.push_back(q);
    }
  }
  if (std::ranges::binary_search(burst.edge, p)) burst.area += area;
  now_.release[p] = expected_release(p);  // until its burst has shown it
  burst.pairs.push_back(p);
  burst.last_held = held;
  burst.opening = opening(p, state);
  kept_.reset();
  add_rows(pair, state, rows);
}

std::shared_ptr<const PartingPairs::State> PartingPairs::state() const {
  if (!kept_) kept_ = std::make_shared<const State>(now_);
  return kept_;
}

void PartingPairs::restore(std::shared_ptr<const State> state) {
  kept_ = std::move(state);
  now_ = *kept_;
}

}  // namespace sunder::fracture
