// SPDX-License-Identifier: Apache-2.0
#include "body/damaged_pools.hpp"

#include <algorithm>
#include <array>

#include "body/pools.hpp"
#include "body/supports.hpp"

namespace sunder::fem {
namespace {

/// Whether the live elements of a patch hang together by nodes without the help of others.
bool holds_itself(const StandingBody& body, std::span<const Index> patch) {
  std::vector<Index> live, front;
  for (Index e : patch) {
    if (body.destroyed.empty() || !body.destroyed[static_cast<std::size_t>(e)]) live.push_back(e);
  }
  if (live.empty()) return true;
  front.push_back(live.back());
  live.pop_back();
  while (!front.empty() && !live.empty()) {
    const std::array<Index, 4> corners = body.corners(front.back());
    front.pop_back();
    const auto apart = std::partition(live.begin(), live.end(), [&](Index e) {
      return std::ranges::find_first_of(corners, body.corners(e)) == corners.end();
    });
    front.insert(front.end(), apart, live.end());
    live.erase(apart, live.end());
  }
  return live.empty();
}

/// By the body that each element belongs to; null: none is split.
std::shared_ptr<const Pools> split_by_bodies(const StandingBody& body, const Pools& pools) {
  const Mesh& mesh = body.problem.mesh();
  Bodies bodies;
  if (body.split.empty()) {
    bodies = find_bodies(mesh, body.destroyed);
  } else {
    Mesh parted;
    parted.tets = mesh.tets;
    Index last = mesh.node_count() - 1;
    for (Index e : body.split) {
      parted.tets[static_cast<std::size_t>(e)] = body.corners(e);
      last = std::max(last, std::ranges::max(body.corners(e)));
    }
    parted.nodes.resize(static_cast<std::size_t>(last) + 1);
    bodies = find_bodies(parted, body.destroyed);
  }
  return pools.split([&](Index e) { return bodies.body_of_element[static_cast<std::size_t>(e)]; });
}

}  // namespace

void DamagedPools::follow(const StandingBody& body, std::span<const Index> elements) {
  const Pools& whole = *body.problem.pools();
  std::vector<Index> touched;
  whole.of(elements, touched);
  for (Index patch : touched) {
    const auto at = std::ranges::lower_bound(candidates_, patch);
    const bool was = at != candidates_.end() && *at == patch;
    const bool is = !holds_itself(body, whole.elements(patch));
    if (is && !was) candidates_.insert(at, patch);
    if (was && !is) candidates_.erase(at);
  }
  split_ =
      body.split.empty() ? nullptr : std::make_shared<const Pools>(whole, body.corners, body.split);
  if (candidates_.empty()) return;
  if (auto split = split_by_bodies(body, split_ ? *split_ : whole)) split_ = std::move(split);
}

}  // namespace sunder::fem
