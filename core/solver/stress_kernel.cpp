// SPDX-License-Identifier: Apache-2.0
#include "solver/stress_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "linear_algebra/shared_loop.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::solver {
namespace {

// Below this many elements a thread more costs as much as it saves (some 10 us to wake one).
constexpr std::size_t kElementsPerThread = 8000;

constexpr double kLive = 1.0 / 3;

constexpr std::size_t kForces = 12 * StressKernel::kLanes;  // of a block's elements

// The maximum shear stress lies between sqrt(3)/2 and 1 times sqrt(J_2); squared, and rounded off.
constexpr double kShearRange = 0.75 * (1 - 1e-9);
// By which a ratio may exceed its bound's, squared: a deviator beside a large pressure.
constexpr double kRounding = 1e-6;

/// Whether (s1 - s3)/2 >= k for a J_2 of k^2 to k^2/0.75, without principal stresses: two of them
/// differ by 2k where the product of all (s_i - s_j)^2 - 4k^2 is 0, and two of the three factors
/// are negative there. In units of k it is 4 J_2^3 - 27 J_3^2 - 36 J_2^2 + 96 J_2 - 64. Nothing:
/// too close to tell.
std::optional<bool> shears(const Voigt& s, double k) {
  const double mean = (s[0] + s[1] + s[2]) / 3;
  if (!(std::abs(mean) <= 1e6 * k)) return std::nullopt;
  const double x = (s[0] - mean) / k, y = (s[1] - mean) / k, z = (s[2] - mean) / k, xy = s[3] / k,
               yz = s[4] / k, zx = s[5] / k;
  const double j2 = (x * x + y * y + z * z) / 2 + (xy * xy + yz * yz + zx * zx);
  const double j3 = x * (y * z - yz * yz) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx);
  const double product = 4 * j2 * j2 * j2 - 27 * j3 * j3 - 36 * j2 * j2 + 96 * j2 - 64;
  if (!(std::abs(product) > 1e-6)) return std::nullopt;  // rounding: 1e-8
  return product > 0;
}

int threads_for(std::size_t elements) {
  const auto machine = static_cast<std::size_t>(linear_algebra::machine_threads());
  return static_cast<int>(std::clamp<std::size_t>(elements / kElementsPerThread, 1, machine));
}

}  // namespace

StressKernel::StressKernel(std::shared_ptr<const Problem> problem, std::vector<Index> elements,
                           int threads)
    : problem_(std::move(problem)) {
  const auto all = static_cast<std::size_t>(problem_->tet_count());
  if (elements.empty()) {
    elements.resize(all);
    std::iota(elements.begin(), elements.end(), 0);
  }
  size_ = elements.size();
  place_.assign(all, kNone);
  blocks_.resize((elements.size() + kLanes - 1) / kLanes, Block{});
  for (std::size_t i = 0; i < blocks_.size() * kLanes; ++i) {
    Block& b = blocks_[i / kLanes];
    const auto l = i % kLanes;
    if (i >= elements.size()) {
      b.element[l] = kNone;  // zeros compute zeros
      continue;
    }
    const Index e = elements[i];
    place_[e] = static_cast<Index>(i);
    b.element[l] = e;
    for (int g = 0; g < 9; ++g) b.gradient[g][l] = problem_->shape(e).gradient(g % 3, g / 3 + 1);
    const SmallStrain law = fem::own_law(*problem_, e);
    b.mu[l] = law.mu;
    b.lambda[l] = law.lambda;
    b.volume[l] = problem_->shape(e).volume;
    bring(b, l, e);
    for (int a = 0; a < 4; ++a) b.corner[a][l] = 3 * problem_->mesh().tets[e][a];
  }
  if (problem_->pools()) {
    if (size_ != all) throw UsageError("pooled volume needs the stress of all elements");
    pooled_.assign(blocks_.size() * kLanes, 0.0);
    pooled_volume_ = pooled_;
    for (Index e = 0; e < problem_->tet_count(); ++e) {
      if (problem_->pools()->of(e) == kNone) continue;
      pooled_volume_[static_cast<std::size_t>(e)] = problem_->shape(e).volume;
    }
  }
  workers_ = std::make_unique<Workers>(threads > 0 ? threads : threads_for(elements.size()));
  partials_.resize(static_cast<std::size_t>(workers_->count()));
}

/// What destroying an element takes away.
void StressKernel::bring(Block& b, std::size_t l, Index e) const {
  const double yield = problem_->yield(e);
  b.scale[l] = 1;
  b.live[l] = kLive;
  b.softness[l] = 1 / (2 * b.mu[l] * b.mu[l]);
  b.strength[l] = yield > 0 ? 1 / (yield * yield) : 0;
}

void StressKernel::revive(std::span<const Index> elements, const fem::Forms& forms) {
  for (Index e : elements) {
    if (place_[e] == kNone) continue;
    const auto at = static_cast<std::size_t>(place_[e]);
    Block& b = blocks_[at / kLanes];
    bring(b, at % kLanes, e);
    const std::array<Index, 4>& corners = forms.corners(e);
    for (std::size_t a = 0; a < 4; ++a) b.corner[a][at % kLanes] = 3 * corners[a];
  }
  take_pools(forms);
}

void StressKernel::take_pools(const fem::Forms& forms) { pools_ = forms.damaged_pools().split(); }

void StressKernel::keep_bounds() { bounds_.assign(blocks_.size() * kLanes, 0.0); }

void StressKernel::keep_forces() {
  forces_.assign(blocks_.size() * kForces, 0.0);
  const auto nodes = problem_->mesh().nodes.size();
  node_begin_.assign(nodes + 1, 0);
  for (const Block& b : blocks_) {
    for (const auto& corner : b.corner) {
      for (int l = 0; l < kLanes && b.element[l] != kNone; ++l) ++node_begin_[corner[l] / 3 + 1];
    }
  }
  for (std::size_t n = 0; n < nodes; ++n) node_begin_[n + 1] += node_begin_[n];
  at_node_.resize(node_begin_.back());
  std::vector<std::size_t> next(node_begin_.begin(), node_begin_.end() - 1);
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Block& b = blocks_[k];
    for (std::size_t l = 0; l < kLanes && b.element[l] != kNone; ++l) {
      for (std::size_t a = 0; a < 4; ++a) {
        at_node_[next[static_cast<std::size_t>(b.corner[a][l] / 3)]++] =
            static_cast<Index>(k * kForces + a * kLanes + l);
      }
    }
  }
}

void StressKernel::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    if (place_[e] == kNone) continue;
    Block& b = blocks_[static_cast<std::size_t>(place_[e] / kLanes)];
    const int l = place_[e] % kLanes;
    b.scale[l] = problem_->scene().fracture.alpha;
    b.live[l] = b.strength[l] = b.softness[l] = 0;
  }
}

void StressKernel::change(std::span<const fem::Coming> come, const fem::Forms& forms) {
  for (const fem::Coming& c : come) {
    if (place_[c.element] == kNone) continue;
    Block& b = blocks_[static_cast<std::size_t>(place_[c.element] / kLanes)];
    const int l = place_[c.element] % kLanes;
    for (std::size_t a = 0; a < 4; ++a) b.corner[a][l] = 3 * c.form.corners[a];
    const auto at = std::ranges::lower_bound(changed_, c.element);
    if (at == changed_.end() || *at != c.element) changed_.insert(at, c.element);
  }
  take_pools(forms);
}

namespace {

/// Of eight elements, (s1 / yield)^2 where s1 may be tension, else 0: s1 is at most the mean stress
/// and 2 sqrt(J_2 / 3).
inline void bound_principal(const double (&s)[6][StressKernel::kLanes],
                            const double (&strength)[StressKernel::kLanes],
                            double (&bound)[StressKernel::kLanes]) {
  for (int l = 0; l < StressKernel::kLanes; ++l) {
    const double x = s[0][l], y = s[1][l], z = s[2][l];
    const double j2 = ((x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x)) / 6 +
                      (s[3][l] * s[3][l] + s[4][l] * s[4][l] + s[5][l] * s[5][l]);
    const double most = (x + y + z) / 3 + 2 * std::sqrt(j2 / 3);
    bound[l] = most > 0 && strength[l] != 0 ? most * most * strength[l] : 0.0;
  }
}

}  // namespace

template <bool kMeasured, bool kPooled>
SUNDER_FORCE_INLINE void StressKernel::run_all(const Block* blocks, std::size_t count,
                                               const double* u, Stores to, Partial& partial) {
  double largest[kLanes] = {}, check[kLanes] = {};
  GroupBounds most{};
  for (std::size_t k = 0; k < count; ++k) {
    const Block& b = blocks[k];
    double d[9][kLanes];
    b.differences(u, d);
    double s[6][kLanes], bound[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      double h[3][3];  // du_i/dx_j
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          // Eigen's orders, so that the bits are those of fem::stress.
          const double a = d[i][l] * b.gradient[j][l], c = d[3 + i][l] * b.gradient[3 + j][l],
                       e = d[6 + i][l] * b.gradient[6 + j][l];
          h[i][j] = i < 2 ? (a + c) + e : a + (c + e);
        }
      }
      const double mu = b.mu[l], two_mu = 2 * mu, scale = b.scale[l];
      double pressure = b.lambda[l] * (h[0][0] + (h[1][1] + h[2][2]));
      if constexpr (kPooled) pressure += to.pressures[k * kLanes + static_cast<std::size_t>(l)];
      const double xx = pressure + two_mu * h[0][0], yy = pressure + two_mu * h[1][1],
                   zz = pressure + two_mu * h[2][2], xy = mu * (h[0][1] + h[1][0]),
                   yz = mu * (h[1][2] + h[2][1]), zx = mu * (h[2][0] + h[0][2]);
      const double normal = xx * xx + yy * yy + zz * zz, shear = xy * xy + yz * yz + zx * zx;
      const double norm = b.live[l] != 0 ? normal + 2 * shear : 0.0;
      largest[l] = norm > largest[l] ? norm : largest[l];
      check[l] += norm * 0;  // not a number if norm is not finite
      const double j2 =
          ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) / 6 + shear;
      bound[l] = b.strength[l] != 0 ? j2 * b.strength[l] : 0.0;
      if constexpr (kMeasured) {
        const double mean = (h[0][0] + (h[1][1] + h[2][2])) * b.live[l];
        most.stretch[l] = mean > most.stretch[l] ? mean : most.stretch[l];
        most.squeeze[l] = -mean > most.squeeze[l] ? -mean : most.squeeze[l];
        const double deviator = j2 * b.softness[l];
        most.deviator[l] = deviator > most.deviator[l] ? deviator : most.deviator[l];
        const double x = h[2][1] - h[1][2], y = h[0][2] - h[2][0], z = h[1][0] - h[0][1];
        const double curl = (x * x + y * y + z * z) * b.live[l];
        most.curl[l] = curl > most.curl[l] ? curl : most.curl[l];
      }
      s[0][l] = scale * xx;
      s[1][l] = scale * yy;
      s[2][l] = scale * zz;
      s[3][l] = scale * xy;
      s[4][l] = scale * yz;
      s[5][l] = scale * zx;
    }
    if (to.bounds) {
      double* at = to.bounds + k * kLanes;
      if (to.principal) bound_principal(s, b.strength, bound);
      for (int l = 0; l < kLanes; ++l) at[l] = bound[l];
    }
    if (kMeasured && (k % kGroup == kGroup - 1 || k + 1 == count)) {
      to.groups[k / kGroup] = most;
      most = {};
    }
    if (to.forces) {
      constexpr int kRow[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};  // Voigt places of a tensor
      double* at = to.forces + k * kForces;
      for (int axis = 0; axis < 3; ++axis, at += 4 * kLanes) {
        const double *x = s[kRow[axis][0]], *y = s[kRow[axis][1]], *z = s[kRow[axis][2]];
        for (int l = 0; l < kLanes; ++l) {
          double sum = 0;
          for (int c = 0; c < 3; ++c) {
            const double f =
                b.volume[l] * (x[l] * b.gradient[3 * c][l] + y[l] * b.gradient[3 * c + 1][l] +
                               z[l] * b.gradient[3 * c + 2][l]);
            at[(c + 1) * kLanes + l] = f;
            sum += f;
          }
          at[l] = -sum;  // the gradients sum to zero
        }
      }
    }
    if (!to.stress) continue;
    for (int l = 0; l < kLanes; ++l) {
      if (b.element[l] == kNone) break;
      double* at = to.stress[k * kLanes + static_cast<std::size_t>(l)].data();
      for (int i = 0; i < 6; ++i) at[i] = s[i][l];
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    partial.largest = std::max(partial.largest, largest[l]);
    partial.check += check[l];
  }
}

SUNDER_VECTORISED
void StressKernel::run_blocks(const Block* blocks, std::size_t count, const double* u, Stores to,
                              Partial& partial) {
  run_all<false, false>(blocks, count, u, to, partial);
}

SUNDER_VECTORISED
void StressKernel::run_and_bound(const Block* blocks, std::size_t count, const double* u, Stores to,
                                 Partial& partial) {
  run_all<true, false>(blocks, count, u, to, partial);
}

SUNDER_VECTORISED
void StressKernel::run_pooled(const Block* blocks, std::size_t count, const double* u, Stores to,
                              Partial& partial) {
  run_all<false, true>(blocks, count, u, to, partial);
}

SUNDER_VECTORISED
void StressKernel::run_pooled_and_bound(const Block* blocks, std::size_t count, const double* u,
                                        Stores to, Partial& partial) {
  run_all<true, true>(blocks, count, u, to, partial);
}

/// Two passes over all elements: what each adds to its patch's volume, and each patch's pressure,
/// summed in the order of its elements: the same bits for any number of threads.
void StressKernel::find_pressures(std::span<const double> u) {
  const fem::Pools& pools = pools_ ? *pools_ : *problem_->pools();
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker), all = partials_.size();
    for (std::size_t k = blocks_.size() * w / all; k < blocks_.size() * (w + 1) / all; ++k) {
      const Block& b = blocks_[k];
      double d[9][kLanes];
      b.differences(u.data(), d);
      for (int l = 0; l < kLanes; ++l) {
        double trace = 0;
        for (int c = 0; c < 3; ++c) {
          for (int axis = 0; axis < 3; ++axis) {
            trace += d[3 * c + axis][l] * b.gradient[3 * c + axis][l];
          }
        }
        const std::size_t at = k * kLanes + static_cast<std::size_t>(l);
        pooled_[at] = b.scale[l] * pooled_volume_[at] * trace;
      }
    }
  });
  workers_->run([&](int worker) {
    const auto w = static_cast<Index>(worker), all = static_cast<Index>(partials_.size());
    const Index count = pools.count();
    for (Index p = count * w / all; p < count * (w + 1) / all; ++p) {
      double change = 0, volume = 0;
      for (Index e : pools.elements(p)) {
        const auto at = static_cast<std::size_t>(e);
        const Block& b = blocks_[at / kLanes];
        change += pooled_[at];
        volume += b.scale[at % kLanes] * pooled_volume_[at];
      }
      const double pressure = pools.bulk(p) * change / volume;
      for (Index e : pools.elements(p)) pooled_[static_cast<std::size_t>(e)] = pressure;
    }
  });
}

double StressKernel::run(std::span<const double> u, std::span<Voigt> stress) {
  return run_storing(
      u, {stress.empty() ? nullptr : stress.data(), bounds_.empty() ? nullptr : bounds_.data(),
          forces_.empty() ? nullptr : forces_.data(), groups_.empty() ? nullptr : groups_.data(),
          strength_measure(problem_->scene().fracture) == YieldMeasure::principal});
}

double StressKernel::largest(std::span<const double> u) { return run_storing(u, Stores{}); }

double StressKernel::run_storing(std::span<const double> u, Stores to) {
  if (!pooled_.empty()) {
    find_pressures(u);
    to.pressures = pooled_.data();
  }
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker), all = partials_.size();
    const std::size_t groups = (blocks_.size() + kGroup - 1) / kGroup;
    const std::size_t begin = groups * w / all * kGroup;
    const std::size_t end = std::min(groups * (w + 1) / all * kGroup, blocks_.size());
    Stores part = to;
    if (part.groups) part.groups += begin / kGroup;
    if (part.bounds) part.bounds += begin * kLanes;
    if (part.forces) part.forces += begin * kForces;
    partials_[w] = {};
    if (part.stress) part.stress += begin * kLanes;
    if (part.pressures) part.pressures += begin * kLanes;
    const auto run = part.pressures ? (part.groups ? &run_pooled_and_bound : &run_pooled)
                     : part.groups  ? &run_and_bound
                                    : &run_blocks;
    run(blocks_.data() + begin, end - begin, u.data(), part, partials_[w]);
  });
  Partial sum;
  for (const Partial& p : partials_) {
    sum.largest = std::max(sum.largest, p.largest);
    sum.check += p.check;
  }
  if (!(sum.check == 0)) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(sum.largest);
}

/// Node by node, in the order of elements: the same sums for any number of threads.
void StressKernel::nodal_forces(std::span<double> forces) {
  workers_->run([&](int worker) {
    const auto w = static_cast<std::size_t>(worker), all = partials_.size();
    const std::size_t nodes = node_begin_.size() - 1;
    for (std::size_t n = nodes * w / all; n < nodes * (w + 1) / all; ++n) {
      double x = 0, y = 0, z = 0;
      for (std::size_t i = node_begin_[n]; i < node_begin_[n + 1]; ++i) {
        const double* f = forces_.data() + at_node_[i];
        x += f[0];
        y += f[4 * kLanes];
        z += f[8 * kLanes];
      }
      forces[3 * n] = x;
      forces[3 * n + 1] = y;
      forces[3 * n + 2] = z;
    }
  });
  const std::size_t first = 3 * (node_begin_.size() - 1);  // of new nodes
  std::ranges::fill(forces.subspan(first), 0.0);
  for (Index e : changed_) {
    const auto at = static_cast<std::size_t>(place_[e]), k = at / kLanes, l = at % kLanes;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(blocks_[k].corner[a][l]);
      if (node < first) continue;
      const double* f = forces_.data() + k * kForces + a * kLanes + l;
      for (std::size_t axis = 0; axis < 3; ++axis) forces[node + axis] += f[axis * 4 * kLanes];
    }
  }
}

Worst StressKernel::worst(std::span<const std::uint8_t> excluded,
                          std::span<const Voigt> stress) const {
  const auto counts = [&](std::size_t i) {
    const Index e = blocks_[i / kLanes].element[i % kLanes];
    return e != kNone && (excluded.empty() || !excluded[e]);
  };
  double largest = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (bounds_[i] > largest && counts(i)) {
      largest = bounds_[i];
      first = i;
    }
  }
  Worst worst;
  if (!(largest > 0)) return worst;
  const YieldMeasure measure = strength_measure(problem_->scene().fracture);
  const auto look_at = [&](std::size_t i) {
    const Index e = blocks_[i / kLanes].element[i % kLanes];
    const double ratio = yield_measure(stress[i], measure) / problem_->yield(e);
    if (ratio > worst.ratio || (ratio == worst.ratio && e < worst.element)) worst = {e, ratio};
  };
  // The ratio is at most the bound's: the largest bound's element leaves few others to look at.
  look_at(first);
  const double least = least_bound() * worst.ratio * worst.ratio * (1 - kRounding);
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (bounds_[i] >= least && bounds_[i] > 0 && i != first && counts(i)) look_at(i);
  }
  return worst;
}

/// Bound of an element whose ratio may just be 1.
double StressKernel::least_bound() const {
  return strength_measure(problem_->scene().fracture) == YieldMeasure::tresca ? 0.25 : 1.0;
}

StressSummary StressKernel::summarize(std::span<const std::uint8_t> excluded,
                                      std::span<const Voigt> stress) const {
  StressSummary summary;
  summary.any = worst({}, stress);
  // The worst of all is the worst candidate too, if it is one.
  const Index worst_of_all = summary.any.element;
  const bool candidate = excluded.empty() || worst_of_all == kNone || !excluded[worst_of_all];
  summary.candidate = candidate ? summary.any : worst(excluded, stress);
  if (!(summary.any.ratio >= 1)) return summary;
  // At or over yield for sure, for sure not, or to be looked at; of shear the bound is J_2 /
  // yield^2.
  const YieldMeasure measure = strength_measure(problem_->scene().fracture);
  const double least = least_bound();
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    if (!(bounds_[i] >= least * (1 - 1e-9))) continue;
    const Index e = blocks_[i / kLanes].element[i % kLanes];
    std::optional<bool> over;
    if (measure != YieldMeasure::principal) {
      over = bounds_[i] * kShearRange > least
                 ? std::optional(true)
                 : shears(stress[i], std::sqrt(least) * problem_->yield(e));
    }
    if (over ? *over : yield_measure(stress[i], measure) / problem_->yield(e) >= 1) {
      ++summary.over;
    }
  }
  return summary;
}

std::size_t StressKernel::bytes() const {
  return blocks_.size() * sizeof(Block) + (bounds_.size() + 2 * pooled_.size()) * sizeof(double) +
         (place_.size() + at_node_.size()) * sizeof(Index) + forces_.size() * sizeof(double) +
         groups_.size() * sizeof(GroupBounds) + cut_off_.size() +
         node_begin_.size() * sizeof(std::size_t);
}

}  // namespace sunder::solver
