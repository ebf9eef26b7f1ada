// SPDX-License-Identifier: Apache-2.0
#include "body/hyperelastic_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "body/deformation.hpp"
#include "body/pooled_law.hpp"
#include "linear_algebra/shared_loop.hpp"
#include "material/linear.hpp"
#include "material/singular_values.hpp"

namespace sunder::fem {
namespace {

// Below this many elements a thread more costs as much as it saves (some 10 us to wake one).
constexpr Index kPassElementsPerThread = 2000;
// So many nodes are sorted by their number of elements.
constexpr std::size_t kNodesSorted = 64;
constexpr std::size_t kBlockForces = 12 * kLanes;

int pass_threads(Index elements) {
  return std::clamp<Index>(elements / kPassElementsPerThread, 1, linear_algebra::machine_threads());
}

Mat3 from_lane(const Lanes<9>& m, int l) {
  Mat3 of;
  for (int i = 0; i < 9; ++i) of(i / 3, i % 3) = m[i][l];
  return of;
}
void into_lane(Lanes<9>& m, int l, const Mat3& of) {
  for (int i = 0; i < 9; ++i) m[i][l] = of(i / 3, i % 3);
}

/// Of the singular values less 1, the one largest in magnitude; of two as large the positive one.
double principal_stretch(const Mat3& h) {
  const Vec3 s = singular_values(Mat3::Identity() + h).s;
  return 1 - s[2] > s[0] - 1 ? s[2] - 1 : s[0] - 1;
}

}  // namespace

void rotate_by_singular_values(RotationInLanes& of, unsigned lanes) {
  for (int l = 0; l < kLanes; ++l) {
    if (!(lanes >> l & 1)) continue;
    const SingularValues s = singular_values(from_lane(of.f, l));
    into_lane(of.r, l, s.u * s.v.transpose());
    of.trace[l] = s.s.sum();
  }
}

void respond_by_law(const Problem& problem, const Law& law, const ElementBlock& block,
                    const double* pressure, ResponseInLanes& of) {
  for (int l = 0; l < kLanes; ++l) {
    Mat3 p = Mat3::Zero();
    of.energy[l] = 0;
    if (block.live[l] != 0) {
      const SmallStrain& constants = problem.small_strain(block.element[l]);
      const Mat3 f = from_lane(of.f, l);
      of.energy[l] = (pressure ? law.split->shape_energy : law.energy)(constants, f);
      if (std::isfinite(of.energy[l])) {
        p = pressure
                ? law.split->shape_stress(constants, f) + pressure[l] * law.split->ratio_slope(f)
                : law.stress(constants, f);
      }
    }
    into_lane(of.p, l, p);
  }
}

void ratios_by_law(const Law& law, const ElementBlock& block, const Lanes<9>& f, double* volumes) {
  for (int l = 0; l < kLanes; ++l) {
    volumes[l] = block.live[l] != 0 ? law.split->ratio(from_lane(f, l)) : 0;
  }
}

HyperelasticPass::HyperelasticPass(const HyperelasticBody& body, int threads)
    : body_(body),
      cut_off_(body.problem.mesh().tets.size(), 0),
      alone_(cut_off_.size(), 0),
      workers_(std::make_unique<Workers>(threads > 0 ? threads
                                                     : pass_threads(body.problem.tet_count()))) {
  arrange();
}

/// Whether an element is live, and whether it counts.
void HyperelasticPass::count_in(ElementBlock& b, int lane) const {
  const Index e = b.element[lane];
  b.live[lane] = body_.live(e) ? 1 : 0;
  b.counts[lane] = cut_off_[e] ? 0 : b.live[lane];
}

/// Elements of one law share blocks, by ascending number.
void HyperelasticPass::arrange() {
  laws_.assign(body_.law_of_volume.begin(), body_.law_of_volume.end());
  blocks_.clear();
  groups_.clear();
  patches_.clear();
  place_.resize(body_.problem.mesh().tets.size());
  std::vector<const Law*> each;
  for (const Law* law : laws_) {
    if (std::ranges::find(each, law) == each.end()) each.push_back(law);
  }
  for (const Law* law : each) {
    for (const bool pooled : {false, true}) {
      for (const bool fibres : {false, true}) arrange({law, 0, 0, pooled, fibres});
    }
    if (body_.problem.interfaces()) arrange({law, 0, 0, false, false, true});
  }
  found_.resize(groups_.size());
  if (!forces_.empty()) place_forces();
}

/// Blocks of the elements of one kind.
void HyperelasticPass::arrange(const ElementGroup& kind) {
  const Problem& problem = body_.problem;
  const std::size_t first = blocks_.size();
  int lane = kLanes;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const bool fibres = problem.small_strain(e).fibres != nullptr;
    if (&body_.law(e) != kind.law || pools_volume(body_, e) != kind.pooled ||
        fibres != kind.fibres || problem.in_interface(e) != kind.layer) {
      continue;
    }
    if (lane == kLanes) {
      lane = 0;
      blocks_.push_back({});
      std::fill_n(blocks_.back().element, kLanes, kNone);
    }
    ElementBlock& b = blocks_.back();
    const TetShape& shape = problem.shape(e);
    for (int g = 0; g < 9; ++g) b.gradient[g][lane] = shape.gradient(g % 3, g / 3 + 1);
    b.mu[lane] = problem.small_strain(e).mu;
    b.lambda[lane] = problem.small_strain(e).lambda;
    b.volume[lane] = shape.volume;
    for (int a = 0; a < 4; ++a) b.corner[a][lane] = 3 * problem.mesh().tets[e][a];
    b.element[lane] = e;
    count_in(b, lane);
    place_[e] = static_cast<Index>((blocks_.size() - 1) * kLanes) + lane;
    ++lane;
  }
  for (std::size_t k = first; k < blocks_.size(); k += ElementGroup::kMost) {
    ElementGroup group = kind;
    group.first = k;
    group.count = std::min(ElementGroup::kMost, blocks_.size() - k);
    groups_.push_back(group);
  }
  if (!kind.pooled || blocks_.size() == first) return;
  volumes_.resize(blocks_.size() * kLanes);
  pressure_.assign(volumes_.size(), 0.0);
  patches_.resize(static_cast<std::size_t>(body_.pools()->count()));
}

/// First J of all elements whose volume is pooled, then their patches' energies and pressures, each
/// patch in the order of its elements: the same bits for any number of threads.
void HyperelasticPass::pool_volumes(std::span<const double> u) {
  const auto threads = static_cast<std::size_t>(workers_->count());
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    for (std::size_t g = groups_.size() * w / threads; g < groups_.size() * (w + 1) / threads;
         ++g) {
      const ElementGroup& group = groups_[g];
      if (!group.pooled) continue;
      find_volumes(group, blocks_.data() + group.first, u.data(),
                   volumes_.data() + group.first * kLanes);
    }
  });
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    for (std::size_t p = patches_.size() * w / threads; p < patches_.size() * (w + 1) / threads;
         ++p) {
      pool_volume(static_cast<Index>(p));
    }
  });
}

void HyperelasticPass::pool_volume(Index patch) {
  const auto elements = body_.pools()->elements(patch);
  patches_[static_cast<std::size_t>(patch)] = 0;
  if (!pools_volume(body_, elements.front())) return;
  double volume = 0, now = 0;
  for (Index e : elements) {
    const Index place = place_[e];
    const ElementBlock& b = blocks_[place / kLanes];
    if (b.live[place % kLanes] == 0 || alone_[e]) continue;
    volume += b.volume[place % kLanes];
    now += b.volume[place % kLanes] * volumes_[place];
  }
  if (!(volume > 0)) return;
  const Index first = elements.front();
  const VolumeSplit::Volume found =
      body_.law(first).split->volume(body_.problem.small_strain(first), now / volume);
  patches_[static_cast<std::size_t>(patch)] = volume * found.energy;
  for (Index e : elements) pressure_[place_[e]] = found.pressure;
}

void HyperelasticPass::split_pools(std::shared_ptr<const Pools> split) {
  if (patches_.empty()) return;
  body_.split = std::move(split);
  patches_.resize(static_cast<std::size_t>(body_.pools()->count()));
}

void HyperelasticPass::leave_alone(std::span<const std::uint8_t> elements) {
  std::ranges::copy(elements, alone_.begin());
}

void HyperelasticPass::place_forces() {
  const Mesh& mesh = body_.problem.mesh();
  forces_.assign((blocks_.size() + 1) * kBlockForces, 0.0);
  const auto zeros = static_cast<Index>(blocks_.size() * kBlockForces);
  std::vector<std::vector<Index>> at(mesh.nodes.size());
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const std::size_t block = static_cast<std::size_t>(place_[e] / kLanes) * kBlockForces;
    for (std::size_t a = 0; a < 4; ++a) {
      at[mesh.tets[e][a]].push_back(static_cast<Index>(block + a * kLanes) + place_[e] % kLanes);
    }
  }
  // By their first element, so that the forces are read about as they were written; of those that
  // lie near each other then, by their number of elements.
  std::vector<Index> order(at.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    const auto first = [&](Index n) { return at[n].empty() ? zeros : at[n].front(); };
    return first(a) < first(b);
  });
  for (std::size_t n = 0; n < order.size(); n += kNodesSorted) {
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(n);
    std::stable_sort(begin,
                     begin + static_cast<std::ptrdiff_t>(std::min(kNodesSorted, order.size() - n)),
                     [&](Index a, Index b) { return at[a].size() > at[b].size(); });
  }
  nodes_.clear();
  at_nodes_.clear();
  for (std::size_t n = 0; n < order.size(); n += 4) {
    FourNodes four{{kNone, kNone, kNone, kNone}, at_nodes_.size(), at_nodes_.size()};
    for (std::size_t j = 0; j < 4 && n + j < order.size(); ++j) {
      four.node[j] = order[n + j];
      const std::vector<Index>& places = at[order[n + j]];
      four.end = std::max(four.end, four.first + places.size());
      at_nodes_.resize(four.end, {zeros, zeros, zeros, zeros});
      for (std::size_t i = 0; i < places.size(); ++i) at_nodes_[four.first + i][j] = places[i];
    }
    nodes_.push_back(four);
  }
}

void HyperelasticPass::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    ElementBlock& b = blocks_[place_[e] / kLanes];
    b.live[place_[e] % kLanes] = b.counts[place_[e] % kLanes] = 0;
  }
}

void HyperelasticPass::body_changed() {
  if (!std::equal(laws_.begin(), laws_.end(), body_.law_of_volume.begin(),
                  body_.law_of_volume.end())) {
    return arrange();
  }
  for (ElementBlock& b : blocks_) {
    for (int l = 0; l < kLanes && b.element[l] != kNone; ++l) count_in(b, l);
  }
}

void HyperelasticPass::cut_off(std::span<const Index> elements) {
  for (Index e : elements) {
    cut_off_[e] = 1;
    blocks_[place_[e] / kLanes].counts[place_[e] % kLanes] = 0;
  }
}

HyperelasticPass::Found HyperelasticPass::run(std::span<const double> u, const Wanted& wanted) {
  if (!wanted.forces.empty() && forces_.empty()) place_forces();
  LaneOutputs to{
      .stress = wanted.measure && !wanted.stress.empty() ? wanted.stress.data() : nullptr,
      .largest = wanted.measure.has_value(),
      .deformation = wanted.deformation,
      .measure = wanted.measure.value_or(StressMeasure::cauchy)};
  if (!patches_.empty()) pool_volumes(u);
  const auto threads = static_cast<std::size_t>(workers_->count());
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    LaneOutputs part = to;
    for (std::size_t g = groups_.size() * w / threads; g < groups_.size() * (w + 1) / threads;
         ++g) {
      const ElementGroup& group = groups_[g];
      if (!wanted.forces.empty()) part.forces = forces_.data() + group.first * kBlockForces;
      part.pressure = group.pooled ? pressure_.data() + group.first * kLanes : nullptr;
      part.measure = group.layer ? StressMeasure::biot : to.measure;
      part.deformation = to.deformation && !group.layer;
      run_group(body_.problem, group, blocks_.data() + group.first, u.data(), part, found_[g]);
    }
  });
  if (!wanted.forces.empty()) sum_forces(wanted.forces);
  return sum_up(wanted, u);
}

/// Node by node, in the order of elements: the same sums for any number of threads. Of four nodes
/// at once, as an addition waits for the one before it.
void HyperelasticPass::sum_forces(std::span<double> forces) {
  const auto threads = static_cast<std::size_t>(workers_->count());
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker);
    for (std::size_t n = nodes_.size() * w / threads; n < nodes_.size() * (w + 1) / threads; ++n) {
      const FourNodes& four = nodes_[n];
      double x[4] = {}, y[4] = {}, z[4] = {};
      for (std::size_t i = four.first; i < four.end; ++i) {
        for (int j = 0; j < 4; ++j) {
          const double* f = forces_.data() + at_nodes_[i][j];
          x[j] += f[0];
          y[j] += f[4 * kLanes];
          z[j] += f[8 * kLanes];
        }
      }
      for (int j = 0; j < 4; ++j) {
        if (four.node[j] == kNone) continue;
        double* f = forces.data() + 3 * four.node[j];
        f[0] = x[j];
        f[1] = y[j];
        f[2] = z[j];
      }
    }
  });
}

HyperelasticPass::Found HyperelasticPass::sum_up(const Wanted& wanted, std::span<const double> u) {
  Found all;
  repaired_ = 0;
  double largest = 0, check = 0;
  for (const GroupFound& group : found_) {
    double energy = 0;
    for (int l = 0; l < kLanes; ++l) {
      energy += group.energy[l];
      largest = std::max(largest, group.largest[l]);
      check += group.check[l];
    }
    all.energy += energy;
    repaired_ += group.repaired;
  }
  for (double energy : patches_) all.energy += energy;
  all.largest = check == 0 ? std::sqrt(largest) : std::numeric_limits<double>::quiet_NaN();
  if (wanted.deformation) all.deformation = deformation(u);
  return all;
}

/// The exact measure of the elements among which the bound's largest is, the one largest in
/// magnitude; of several such lanes the first.
template <class Measure>
double HyperelasticPass::most_by(const double (GroupFound::*bound)[kLanes],
                                 Measure&& measure) const {
  double largest = 0;
  std::size_t group = 0;
  int lane = 0;
  for (std::size_t g = 0; g < found_.size(); ++g) {
    for (int l = 0; l < kLanes; ++l) {
      if (!((found_[g].*bound)[l] > largest)) continue;
      largest = (found_[g].*bound)[l];
      group = g;
      lane = l;
    }
  }
  double most = 0;
  if (!(largest > 0)) return most;
  for (std::size_t k = 0; k < groups_[group].count; ++k) {
    const ElementBlock& b = blocks_[groups_[group].first + k];
    if (b.counts[lane] == 0) continue;
    const double here = measure(b.element[lane]);
    if (std::abs(here) > std::abs(most)) most = here;
  }
  return most;
}

Deformation HyperelasticPass::deformation(std::span<const double> u) const {
  Deformation found;
  for (const GroupFound& group : found_) {
    for (double inverted : group.inverted) found.inverted += static_cast<Index>(inverted);
  }
  const auto gradient = [&](Index e) { return displacement_gradient(body_.problem, e, u); };
  found.strain = most_by(&GroupFound::strain, [&](Index e) {
    return &body_.law(e) == &kLinear ? principal_strain(gradient(e))
                                     : principal_stretch(gradient(e));
  });
  found.rotation_deg =
      most_by(&GroupFound::turn, [&](Index e) { return rotation_deg(gradient(e)); });
  return found;
}

std::size_t HyperelasticPass::bytes() const {
  return blocks_.size() * sizeof(ElementBlock) + groups_.size() * sizeof(ElementGroup) +
         found_.size() * sizeof(GroupFound) + place_.size() * sizeof(Index) + cut_off_.size() +
         forces_.size() * sizeof(double) + nodes_.size() * sizeof(FourNodes) +
         at_nodes_.size() * sizeof(at_nodes_[0]) + alone_.size() +
         (volumes_.size() + pressure_.size() + patches_.size()) * sizeof(double);
}

}  // namespace sunder::fem
