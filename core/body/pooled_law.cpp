// SPDX-License-Identifier: Apache-2.0
#include "body/pooled_law.hpp"

#include <algorithm>
#include <numeric>

#include "body/deformation.hpp"

namespace sunder::fem {
namespace {

/// V_p, and what the law says of J_p; without a live element 0.
struct PatchVolume {
  double volume = 0;
  VolumeSplit::Volume found{0, 0, 0};
};
PatchVolume volume_of(const HyperelasticBody& body, Index patch, std::span<const double> u) {
  PatchVolume of;
  double now = 0;
  const auto elements = body.pools()->elements(patch);
  for (Index e : elements) {
    if (!body.live(e) || !pools_volume(body, e)) continue;
    const double volume = body.problem.shape(e).volume;
    const Mat3 f = Mat3::Identity() + displacement_gradient(body.problem, e, u);
    of.volume += volume;
    now += volume * body.law(e).split->ratio(f);
  }
  if (!(of.volume > 0)) return of;
  const Index first = elements.front();
  of.found = body.law(first).split->volume(body.problem.small_strain(first), now / of.volume);
  return of;
}

}  // namespace

bool pools_volume(const HyperelasticBody& body, Index element) {
  const Pools* pools = body.pools();
  return pools && pools->of(element) != kNone && body.law(element).split;
}

PatchVolumes::PatchVolumes(const HyperelasticBody& body, std::span<const double> u,
                           std::span<const double> pressure) {
  const Pools* pools = body.pools();
  if (!pools) return;
  for (Index p = 0; p < pools->count(); ++p) {
    const PatchVolume of = volume_of(body, p, u);
    energy_.push_back(of.volume > 0 ? of.volume * of.found.energy : 0);
    pressure_.push_back(of.found.pressure);
    stiffness_.push_back(of.found.stiffness);
  }
  if (!pressure.empty()) pressure_.assign(pressure.begin(), pressure.end());
}

void PatchVolumes::part(const Pools& was, const Pools& is) {
  const PatchVolumes whole = std::move(*this);
  *this = {};
  for (Index p = 0; p < is.count(); ++p) {
    const auto of = static_cast<std::size_t>(was.of(is.elements(p).front()));
    energy_.push_back(0);
    pressure_.push_back(whole.pressure_[of]);
    stiffness_.push_back(whole.stiffness_[of]);
  }
}

double patch_pressure(const HyperelasticBody& body, Index patch, std::span<const double> u) {
  return volume_of(body, patch, u).found.pressure;
}

double PatchVolumes::energy() const { return std::accumulate(energy_.begin(), energy_.end(), 0.0); }

PatchTangent patch_tangent(const HyperelasticBody& body, Index patch, std::span<const double> u,
                           double stiffness, Tangent kind) {
  const Problem& problem = body.problem;
  const Pools& pools = *body.pools();
  const std::vector<Index> nodes = pools.nodes(problem, patch);
  PatchTangent of;
  double volume = 0;
  for (Index e : pools.elements(patch)) {
    if (!body.live(e) || !pools_volume(body, e)) continue;
    if (volume == 0) of.b.setZero(3 * static_cast<Eigen::Index>(nodes.size()));
    const TetShape& shape = problem.shape(e);
    volume += shape.volume;
    const Eigen::Matrix<double, 3, 4> at =
        shape.volume *
        (body.law(e).split->ratio_slope(Mat3::Identity() + displacement_gradient(problem, e, u)) *
         shape.gradient);
    const auto& tet = problem.mesh().tets[static_cast<std::size_t>(e)];
    for (int a = 0; a < 4; ++a) {
      const auto place = std::ranges::lower_bound(nodes, tet[static_cast<std::size_t>(a)]);
      of.b.segment<3>(3 * (place - nodes.begin())) += at.col(a);
    }
  }
  if (volume > 0)
    of.factor = (kind == Tangent::exact ? stiffness : std::max(0.0, stiffness)) / volume;
  return of;
}

std::vector<PatchTangent> patch_tangents(const HyperelasticBody& body, std::span<const double> u,
                                         std::span<const double> stiffness, Tangent kind) {
  std::vector<PatchTangent> all;
  for (std::size_t p = 0; p < stiffness.size(); ++p) {
    all.push_back(patch_tangent(body, static_cast<Index>(p), u, stiffness[p], kind));
  }
  return all;
}

}  // namespace sunder::fem
