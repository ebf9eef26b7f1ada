// SPDX-License-Identifier: Apache-2.0
// Loops over lanes that become vector instructions. Compiled with -fno-math-errno and
// -fno-trapping-math, which change no number: square roots need no call then, and both sides of a
// choice may be computed. What a loop writes is local to the function, so that nothing it reads can
// be the same memory.
#include "body/hyperelastic_lanes.hpp"

#include <bit>
#include <cmath>

#include "machine/compiler.hpp"
#include "material/corotated.hpp"
#include "material/lanes.hpp"
#include "material/linear.hpp"
#include "material/neo_hookean.hpp"
#include "material/saint_venant_kirchhoff.hpp"

namespace sunder::fem {
namespace {

using lanes::Matrix;

// More of Newton's steps for a block of which a lane has not found its sum.
constexpr int kMoreSteps = 8;

SUNDER_IN_LANES Matrix at_lane(const Lanes<9>& m, int l) {
  return {{{m[0][l], m[1][l], m[2][l]}, {m[3][l], m[4][l], m[5][l]}, {m[6][l], m[7][l], m[8][l]}}};
}
SUNDER_IN_LANES void to_lane(Lanes<9>& m, int l, const Matrix& of) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[3 * i + j][l] = of.at[i][j];
  }
}
SUNDER_IN_LANES double larger(double a, double b) { return a > b ? a : b; }

/// F = I + grad u of a group's elements. The displacements come one by one, so that what each
/// instruction fetches is little; as vectors they are read when all are there.
SUNDER_IN_LANES void gradients(const ElementBlock* blocks, std::size_t count, const double* u,
                               Lanes<9>* f) {
  for (std::size_t k = 0; k < count; ++k) {
    const ElementBlock& b = blocks[k];
#pragma GCC unroll 1
    for (int l = 0; l < kLanes; ++l) {
      const double* at = u + b.corner[0][l];
      for (int c = 0; c < 3; ++c) {  // against corner 0
        const double* corner = u + b.corner[c + 1][l];
        for (int axis = 0; axis < 3; ++axis) f[k][3 * c + axis][l] = corner[axis] - at[axis];
      }
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const ElementBlock& b = blocks[k];
    for (int l = 0; l < kLanes; ++l) {
      const Matrix d = at_lane(f[k], l);  // row: corner
      Matrix of;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const double h = d.at[0][i] * b.gradient[j][l] + d.at[1][i] * b.gradient[3 + j][l] +
                           d.at[2][i] * b.gradient[6 + j][l];
          of.at[i][j] = i == j ? 1 + h : h;
        }
      }
      to_lane(f[k], l, of);
    }
  }
}

/// Of a group's elements, one after the other.
struct Sums {
  static constexpr std::size_t kAll = ElementGroup::kMost * kLanes;
  double square[kAll], cofactors[kAll], volume[kAll];  // lanes::Invariants
  double t[kAll], open[kAll];                          // lanes::Sum
};

/// Newton's steps wait for each other: those of several blocks run side by side.
SUNDER_IN_LANES void sums_of_singular_values(const Lanes<9>* f, std::size_t count, Sums& of) {
  for (std::size_t k = 0; k < count; ++k) {
    for (int l = 0; l < kLanes; ++l) {
      const Matrix at = at_lane(f[k], l);
      const lanes::Invariants in = lanes::invariants(at, lanes::cofactor(at));
      of.square[k * kLanes + l] = in.square;
      of.cofactors[k * kLanes + l] = in.cofactors;
      of.volume[k * kLanes + l] = in.volume;
    }
  }
  for (std::size_t i = 0; i < count * kLanes; ++i) {
    const lanes::Sum sum =
        lanes::sum_of_singular_values({of.square[i], of.cofactors[i], of.volume[i]});
    of.t[i] = sum.t;
    of.open[i] = sum.open;
  }
}

/// Of live lanes that are not <= 0.
SUNDER_IN_LANES unsigned over_zero(const ElementBlock& b, const double (&x)[kLanes]) {
  unsigned lanes = 0;
  for (int l = 0; l < kLanes; ++l) {
    lanes |= static_cast<unsigned>(b.live[l] != 0 && !(x[l] <= 0)) << l;
  }
  return lanes;
}

/// R of a block, `first` its first element in `sums`. Returns how many lanes took the scalar way.
SUNDER_IN_LANES std::size_t rotations(const ElementBlock& b, const Lanes<9>& f, Sums& sums,
                                      std::size_t first, Lanes<9>& r, double (&trace)[kLanes]) {
  double open[kLanes], weak[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    trace[l] = sums.t[first + l];
    open[l] = sums.open[first + l];
  }
  if (over_zero(b, open) != 0) {
    for (int step = 0; step < kMoreSteps; ++step) {
      for (int l = 0; l < kLanes; ++l) {
        const lanes::Sum sum = lanes::newton_step(
            trace[l], {sums.square[first + l], sums.cofactors[first + l], sums.volume[first + l]});
        const bool more = open[l] > 0;
        trace[l] = more ? sum.t : trace[l];
        open[l] = more ? sum.open : open[l];
      }
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    const Matrix at = at_lane(f, l);
    const lanes::Rotation found = lanes::rotation(
        at, lanes::cofactor(at), trace[l],
        {sums.square[first + l], sums.cofactors[first + l], sums.volume[first + l]});
    to_lane(r, l, found.r);
    weak[l] = open[l] <= 0 ? found.weak : 1.0;
  }
  const unsigned left = over_zero(b, weak);
  if (left == 0) return 0;
  RotationInLanes scalar;
  for (int i = 0; i < 9; ++i) {
    for (int l = 0; l < kLanes; ++l) {
      scalar.f[i][l] = f[i][l];
      scalar.r[i][l] = r[i][l];
    }
  }
  for (int l = 0; l < kLanes; ++l) scalar.trace[l] = trace[l];
  rotate_by_singular_values(scalar, left);
  for (int i = 0; i < 9; ++i) {
    for (int l = 0; l < kLanes; ++l) r[i][l] = scalar.r[i][l];
  }
  for (int l = 0; l < kLanes; ++l) trace[l] = scalar.trace[l];
  return static_cast<std::size_t>(std::popcount(left));
}

enum class LaneLaw {
  linear,
  corotated,
  neo_hookean,
  saint_venant_kirchhoff,
  linear_shape,  // and these with the pressure of a patch
  corotated_shape,
  neo_hookean_shape,
  saint_venant_kirchhoff_shape,
  other,
  other_linear
};

/// Of small strains, which know but one stress.
constexpr bool small_strains(LaneLaw law) {
  return law == LaneLaw::linear || law == LaneLaw::linear_shape || law == LaneLaw::other_linear;
}

/// lambda without a resistance to a change of volume.
SUNDER_IN_LANES double of_shape(double mu) { return mu * (-2.0 / 3); }

SUNDER_IN_LANES void add_pressure(double pressure, const Matrix& slope, Matrix& p) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) p.at[i][j] += pressure * slope.at[i][j];
  }
}

/// W and P. `pressure`: as respond_by_law has it.
template <LaneLaw kLaw>
SUNDER_IN_LANES void responses(const Problem& problem, const Law& law, const ElementBlock& b,
                               const Lanes<9>& f, const Lanes<9>& r, const double (&trace)[kLanes],
                               const double* pressure, Lanes<9>& p, double (&energy)[kLanes]) {
  if constexpr (kLaw == LaneLaw::other || kLaw == LaneLaw::other_linear) {
    ResponseInLanes scalar;
    for (int i = 0; i < 9; ++i) {
      for (int l = 0; l < kLanes; ++l) scalar.f[i][l] = f[i][l];
    }
    respond_by_law(problem, law, b, pressure, scalar);
    for (int i = 0; i < 9; ++i) {
      for (int l = 0; l < kLanes; ++l) p[i][l] = scalar.p[i][l];
    }
    for (int l = 0; l < kLanes; ++l) energy[l] = scalar.energy[l];
  } else {
    for (int l = 0; l < kLanes; ++l) {
      const double mu = b.mu[l], lambda = b.lambda[l];
      const Matrix at = at_lane(f, l);
      lanes::Response of;
      if constexpr (kLaw == LaneLaw::linear) of = lanes::linear(mu, lambda, at);
      if constexpr (kLaw == LaneLaw::corotated) {
        of = lanes::corotated(mu, lambda, at, at_lane(r, l), trace[l]);
      }
      if constexpr (kLaw == LaneLaw::neo_hookean) of = lanes::neo_hookean(mu, lambda, at);
      if constexpr (kLaw == LaneLaw::linear_shape) {
        of = lanes::linear(mu, of_shape(mu), at);
        for (int i = 0; i < 3; ++i) of.p.at[i][i] += pressure[l];
      }
      if constexpr (kLaw == LaneLaw::corotated_shape) {
        const Matrix turned = at_lane(r, l);
        of = lanes::corotated(mu, of_shape(mu), at, turned, trace[l]);
        add_pressure(pressure[l], turned, of.p);
      }
      if constexpr (kLaw == LaneLaw::neo_hookean_shape) {
        of = lanes::neo_hookean_shape(mu, pressure[l], at);
      }
      if constexpr (kLaw == LaneLaw::saint_venant_kirchhoff_shape) {
        of = lanes::saint_venant_kirchhoff(mu, of_shape(mu), at);
        add_pressure(pressure[l], at, of.p);
      }
      if constexpr (kLaw == LaneLaw::saint_venant_kirchhoff) {
        of = lanes::saint_venant_kirchhoff(mu, lambda, at);
      }
      to_lane(p, l, of.p);
      energy[l] = of.energy;
    }
  }
}

/// V P grad N on the corners: axis, corner, lane.
SUNDER_IN_LANES void corner_forces(const ElementBlock& b, const Lanes<9>& p,
                                   const double (&energy)[kLanes], double* to) {
  Lanes<12> force;
  for (int l = 0; l < kLanes; ++l) {
    // None of an element that is gone, or is in no state of its law.
    const double state = b.live[l] != 0 ? energy[l] - energy[l] : 1.0;
    const bool acts = state == 0;
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for (int corner = 0; corner < 3; ++corner) {
        const double of = b.volume[l] * (p[3 * axis][l] * b.gradient[3 * corner][l] +
                                         p[3 * axis + 1][l] * b.gradient[3 * corner + 1][l] +
                                         p[3 * axis + 2][l] * b.gradient[3 * corner + 2][l]);
        force[4 * axis + corner + 1][l] = acts ? of : 0.0;
        sum += of;
      }
      force[4 * axis][l] = acts ? -sum : 0.0;  // the gradients sum to zero
    }
  }
  for (int i = 0; i < 12; ++i) {
    for (int l = 0; l < kLanes; ++l) to[i * kLanes + l] = force[i][l];
  }
}

SUNDER_IN_LANES void store(const lanes::Symmetric& of, Lanes<6>& s, int l) {
  s[0][l] = of.xx;
  s[1][l] = of.yy;
  s[2][l] = of.zz;
  s[3][l] = of.xy;
  s[4][l] = of.yz;
  s[5][l] = of.zx;
}

/// The symmetric part.
SUNDER_IN_LANES lanes::Symmetric symmetric_part(const Matrix& of) {
  const auto mean = [&](int i, int j) { return (of.at[i][j] + of.at[j][i]) / 2; };
  return {of.at[0][0], of.at[1][1], of.at[2][2], mean(0, 1), mean(1, 2), mean(2, 0)};
}

/// By the chosen measure, of the linear law its only one, P; of what is in no state of its law no
/// number, of what is gone 0.
template <LaneLaw kLaw>
SUNDER_IN_LANES void stresses(const ElementBlock& b, const Lanes<9>& f, const Lanes<9>& r,
                              const Lanes<9>& p, const double (&energy)[kLanes],
                              const LaneOutputs& to, GroupFound& found) {
  Lanes<6> s;
  double one_over[kLanes];
  if constexpr (small_strains(kLaw)) {
    for (int l = 0; l < kLanes; ++l) {
      store(symmetric_part(at_lane(p, l)), s, l);
      one_over[l] = 1;
    }
  } else if (to.measure == StressMeasure::cauchy) {
    for (int l = 0; l < kLanes; ++l) {
      const Matrix at = at_lane(f, l);
      const lanes::Symmetric of = lanes::symmetric_product_by_rows(at_lane(p, l), at);
      store(of, s, l);
      one_over[l] = 1 / lanes::determinant(at, lanes::cofactor(at));
    }
  } else {
    for (int l = 0; l < kLanes; ++l) {
      const lanes::Symmetric of = lanes::symmetric_product(at_lane(r, l), at_lane(p, l));
      store(of, s, l);
      one_over[l] = 1;
    }
  }
  double largest[kLanes], check[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const double no_state = energy[l] - energy[l];
    for (int i = 0; i < 6; ++i) {
      const double value = s[i][l] * one_over[l] + no_state;
      s[i][l] = b.live[l] != 0 ? value : 0.0;
    }
    const double norm = lanes::squared_norm({s[0][l], s[1][l], s[2][l], s[3][l], s[4][l], s[5][l]});
    largest[l] = b.counts[l] != 0 ? norm : 0.0;
    check[l] = largest[l] * 0;
  }
  for (int l = 0; l < kLanes; ++l) {
    found.largest[l] = larger(largest[l], found.largest[l]);
    found.check[l] += check[l];
  }
  if (!to.stress) return;
  for (int l = 0; l < kLanes; ++l) {
    if (b.element[l] == kNone) continue;
    double* at = to.stress[b.element[l]].data();
    for (int i = 0; i < 6; ++i) at[i] = s[i][l];
  }
}

/// Strain U - I, by the linear law that of small strains.
template <LaneLaw kLaw>
SUNDER_IN_LANES void deformations(const ElementBlock& b, const Lanes<9>& f, const Lanes<9>& r,
                                  GroupFound& found) {
  double strain[kLanes], turn[kLanes], inverted[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const Matrix at = at_lane(f, l), turned = at_lane(r, l);
    Matrix apart;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) apart.at[i][j] = at.at[i][j] - turned.at[i][j];
    }
    lanes::Symmetric of = lanes::symmetric_product(turned, apart);
    if constexpr (small_strains(kLaw)) {
      of = symmetric_part(at);
      of.xx -= 1;
      of.yy -= 1;
      of.zz -= 1;
    }
    const double most = lanes::largest_principal(of);
    const double angle = lanes::one_less_cosine(turned);
    const double volume = lanes::determinant(at, lanes::cofactor(at));
    const bool counts = b.counts[l] != 0;
    strain[l] = counts ? most : 0.0;
    turn[l] = counts ? angle : 0.0;
    inverted[l] = counts && volume <= 0 ? 1.0 : 0.0;
  }
  for (int l = 0; l < kLanes; ++l) {
    found.strain[l] = larger(strain[l], found.strain[l]);
    found.turn[l] = larger(turn[l], found.turn[l]);
    found.inverted[l] += inverted[l];
  }
}

struct Range {
  const Problem& problem;
  const Law& law;
  const ElementBlock* blocks;
  std::size_t count;
};

template <LaneLaw kLaw>
SUNDER_IN_LANES void run_blocks(const Range& of, const double* u, const LaneOutputs& to,
                                GroupFound& found) {
  const bool stressed = to.stress || to.largest;
  const bool turned = kLaw == LaneLaw::corotated || kLaw == LaneLaw::corotated_shape ||
                      to.deformation || (stressed && to.measure == StressMeasure::biot);
  double energy[kLanes] = {};
  Lanes<9> gradient[ElementGroup::kMost];
  gradients(of.blocks, of.count, u, gradient);
  Sums sums;
  if (turned) sums_of_singular_values(gradient, of.count, sums);
  for (std::size_t k = 0; k < of.count; ++k) {
    const ElementBlock& b = of.blocks[k];
    const Lanes<9>& f = gradient[k];
    Lanes<9> r, p;
    double trace[kLanes], w[kLanes];
    if (turned) found.repaired += rotations(b, f, sums, k * kLanes, r, trace);
    const double* pressure = to.pressure ? to.pressure + k * kLanes : nullptr;
    responses<kLaw>(of.problem, of.law, b, f, r, trace, pressure, p, w);
    for (int l = 0; l < kLanes; ++l) energy[l] += b.live[l] != 0 ? b.volume[l] * w[l] : 0.0;
    if (to.forces) corner_forces(b, p, w, to.forces + k * 12 * kLanes);
    if (stressed) stresses<kLaw>(b, f, r, p, w, to, found);
    if (to.deformation) deformations<kLaw>(b, f, r, found);
  }
  for (int l = 0; l < kLanes; ++l) found.energy[l] = energy[l];
}

SUNDER_VECTORISED
void run_linear(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::linear>(of, u, to, found);
}
SUNDER_VECTORISED
void run_corotated(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::corotated>(of, u, to, found);
}
SUNDER_VECTORISED
void run_neo_hookean(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::neo_hookean>(of, u, to, found);
}
SUNDER_VECTORISED
void run_saint_venant_kirchhoff(const Range& of, const double* u, const LaneOutputs& to,
                                GroupFound& found) {
  run_blocks<LaneLaw::saint_venant_kirchhoff>(of, u, to, found);
}
SUNDER_VECTORISED
void run_linear_shape(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::linear_shape>(of, u, to, found);
}
SUNDER_VECTORISED
void run_corotated_shape(const Range& of, const double* u, const LaneOutputs& to,
                         GroupFound& found) {
  run_blocks<LaneLaw::corotated_shape>(of, u, to, found);
}
SUNDER_VECTORISED
void run_neo_hookean_shape(const Range& of, const double* u, const LaneOutputs& to,
                           GroupFound& found) {
  run_blocks<LaneLaw::neo_hookean_shape>(of, u, to, found);
}
SUNDER_VECTORISED
void run_saint_venant_kirchhoff_shape(const Range& of, const double* u, const LaneOutputs& to,
                                      GroupFound& found) {
  run_blocks<LaneLaw::saint_venant_kirchhoff_shape>(of, u, to, found);
}

/// J of each element, as VolumeSplit::ratio has it.
template <LaneLaw kLaw>
SUNDER_IN_LANES void volumes_of_blocks(const ElementBlock* blocks, std::size_t count,
                                       const double* u, double* volumes) {
  Lanes<9> gradient[ElementGroup::kMost];
  gradients(blocks, count, u, gradient);
  Sums sums;
  if constexpr (kLaw == LaneLaw::corotated_shape) sums_of_singular_values(gradient, count, sums);
  for (std::size_t k = 0; k < count; ++k) {
    double trace[kLanes];
    if constexpr (kLaw == LaneLaw::corotated_shape) {
      Lanes<9> r;
      rotations(blocks[k], gradient[k], sums, k * kLanes, r, trace);
    }
    for (int l = 0; l < kLanes; ++l) {
      const Matrix at = at_lane(gradient[k], l);
      double j = 0;
      if constexpr (kLaw == LaneLaw::linear_shape) {
        j = 1 + ((at.at[0][0] - 1) + (at.at[1][1] - 1) + (at.at[2][2] - 1));
      }
      if constexpr (kLaw == LaneLaw::corotated_shape) j = trace[l] - 2;
      if constexpr (kLaw == LaneLaw::neo_hookean_shape) {
        j = lanes::determinant(at, lanes::cofactor(at));
      }
      if constexpr (kLaw == LaneLaw::saint_venant_kirchhoff_shape) {
        j = 1 + 0.5 * (lanes::inner(at, at) - 3);
      }
      volumes[k * kLanes + l] = j;
    }
  }
}
SUNDER_VECTORISED
void linear_volumes(const ElementBlock* blocks, std::size_t count, const double* u,
                    double* volumes) {
  volumes_of_blocks<LaneLaw::linear_shape>(blocks, count, u, volumes);
}
SUNDER_VECTORISED
void corotated_volumes(const ElementBlock* blocks, std::size_t count, const double* u,
                       double* volumes) {
  volumes_of_blocks<LaneLaw::corotated_shape>(blocks, count, u, volumes);
}
SUNDER_VECTORISED
void neo_hookean_volumes(const ElementBlock* blocks, std::size_t count, const double* u,
                         double* volumes) {
  volumes_of_blocks<LaneLaw::neo_hookean_shape>(blocks, count, u, volumes);
}
SUNDER_VECTORISED
void saint_venant_kirchhoff_volumes(const ElementBlock* blocks, std::size_t count, const double* u,
                                    double* volumes) {
  volumes_of_blocks<LaneLaw::saint_venant_kirchhoff_shape>(blocks, count, u, volumes);
}
SUNDER_VECTORISED
void run_other(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::other>(of, u, to, found);
}
SUNDER_VECTORISED
void run_other_linear(const Range& of, const double* u, const LaneOutputs& to, GroupFound& found) {
  run_blocks<LaneLaw::other_linear>(of, u, to, found);
}

auto loop_of(const ElementGroup& group) {
  const Law& law = *group.law;
  if (group.fibres) return &law == &kLinear ? &run_other_linear : &run_other;
  if (group.pooled) {
    if (&law == &kLinear) return &run_linear_shape;
    if (&law == &kCorotated) return &run_corotated_shape;
    if (&law == &kNeoHookean) return &run_neo_hookean_shape;
    if (&law == &kSaintVenantKirchhoff) return &run_saint_venant_kirchhoff_shape;
    return &run_other;
  }
  if (&law == &kLinear) return &run_linear;
  if (&law == &kCorotated) return &run_corotated;
  if (&law == &kNeoHookean) return &run_neo_hookean;
  if (&law == &kSaintVenantKirchhoff) return &run_saint_venant_kirchhoff;
  return &run_other;
}

}  // namespace

void run_group(const Problem& problem, const ElementGroup& group, const ElementBlock* blocks,
               const double* u, const LaneOutputs& to, GroupFound& found) {
  found = {};
  loop_of(group)({problem, *group.law, blocks, group.count}, u, to, found);
}

void find_volumes(const ElementGroup& group, const ElementBlock* blocks, const double* u,
                  double* volumes) {
  const Law& law = *group.law;
  if (&law == &kLinear) return linear_volumes(blocks, group.count, u, volumes);
  if (&law == &kCorotated) return corotated_volumes(blocks, group.count, u, volumes);
  if (&law == &kNeoHookean) return neo_hookean_volumes(blocks, group.count, u, volumes);
  if (&law == &kSaintVenantKirchhoff) {
    return saint_venant_kirchhoff_volumes(blocks, group.count, u, volumes);
  }
  Lanes<9> gradient[ElementGroup::kMost];
  gradients(blocks, group.count, u, gradient);
  for (std::size_t k = 0; k < group.count; ++k) {
    ratios_by_law(law, blocks[k], gradient[k], volumes + k * kLanes);
  }
}

}  // namespace sunder::fem
