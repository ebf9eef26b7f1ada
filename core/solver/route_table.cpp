// SPDX-License-Identifier: Apache-2.0
#include "solver/route_table.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "body/eight_products.hpp"
#include "sunder/words.hpp"

namespace sunder::solver {
namespace {

// Above this many unknowns a dense inverse (8 n^2 bytes) is not chosen by itself: 288 MB and
// seconds to prepare (n^2 nnz(L)), while the factor's frame is still within a millisecond of it.
constexpr std::size_t kDenseLimit = 6000;
// A device that makes the inverse itself takes a larger one by itself where it is made within so
// many seconds, by half of what the device can do, and half of its memory holds it: frames whose
// load has turned or in which something breaks then take no iterations, and read their new columns
// there. Bytes of a value while it is made, in place where it is stored in as many; columns of a
// step of the inversion.
constexpr double kPreparation = 5, kOfItsRates = .5, kOfItsMemory = .5;
constexpr double kInversionBytes = 8, kInversionColumns = 60;

// Steps along solutions that are known, each as much work as an iteration: under a load that has
// only grown they are all that conjugate gradients on a device take.
constexpr double kKnownSteps = 2;
constexpr double kTouched = 12;     // unknowns of a first fracture
constexpr double kRank = 6;         // of the update that it brings
constexpr double kDifferences = 9;  // of them, that the element resists: columns of the damage
// Iterations of conjugate gradients preconditioned by the intact body: none broken, one broken.
constexpr double kQuietIterations = 1, kFractureIterations = 6;
// By an incomplete factor, for the cube root of the unknowns; a new crack hardly adds to them.
constexpr double kIncompleteIterations = 8;
constexpr double kStiffness = 22;  // entries of the stiffness for each unknown, lower triangle

// Of the small matrices, for each pair of columns: values of half of G, M and D, how often the
// forces of damage read them (.4 ms at 800 columns), and values that an update reads.
constexpr double kHalves = 1.5, kForcesOfDamage = 5. / 3, kUpdateOfDamage = 3;
// Products of whole matrices on a device that has them, a dispatch each.
constexpr double kProductsThere = 13;

std::string megabytes(std::size_t bytes) {
  if (bytes < 10000000) return std::to_string(bytes / 1000) + " kB";
  return std::to_string(bytes / 1000000) + " MB";
}

std::size_t inverse_bytes(std::size_t n) { return n * n * sizeof(double); }

double real(std::size_t count) { return static_cast<double>(count); }

std::string nothing(const Question&) { return {}; }
std::size_t no_bytes(const Question&) { return 0; }
bool always(const Question&) { return true; }

std::string asked_for(const std::string& detail = {}) {
  return "asked for" + (detail.empty() ? detail : "; " + detail);
}

// condensed: the inverse of a region, always on the host.

std::string against_condensed(const Question& q) {
  if (q.problem.pools()) {
    return "route condensed does not compute pooled volume (volume = \"pooled\"); use route "
           "factor, "
           "inverse or cg";
  }
  if (q.needs.split) {
    return "route condensed has no room for the unknowns which split nodes bring; use route "
           "inverse "
           "or factor";
  }
  if (q.device.displayed) {
    return "route condensed keeps a region's fields alone on the device, but the host draws those "
           "of the whole body; use route inverse or cg";
  }
  if (!q.problem.scene().gravity.isZero(0)) {
    return "route condensed takes loads in its region alone, but gravity loads the whole body; use "
           "route factor or cg";
  }
  if (!q.device.rates.apart() || !q.region().elements.empty()) return {};
  return "route condensed needs elements that can break or be destroyed, of which this scene has "
         "none; use route inverse or cg";
}

std::size_t condensed_bytes(const Question& q) {
  return q.device.rates.apart() ? 0 : 2 * inverse_bytes(q.region().dofs.size());
}

bool condensed_pays(const Question& q) {
  return q.needs.damage && q.problem.scene().gravity.isZero(0) && q.region().tears &&
         kRegionShare * q.region().dofs.size() <= q.unknowns() &&
         q.region().dofs.size() <= kDenseLimit;
}

std::string why_condensed(const Question& q) {
  const std::size_t inside = q.region().dofs.size();
  const std::string held = " can break, are loaded or held by instruments";
  if (q.asked) return asked_for(std::to_string(inside) + " of " + unknowns_of(q) + held);
  return unknowns_of(q) + ", of which " + std::to_string(inside) + held + ": their inverse takes " +
         megabytes(inverse_bytes(inside)) + ", and a frame computes nothing else";
}

/// By the small matrices.
void forces_of_damage(FrameWork& work, const FrameShape& s, bool torn) {
  if (!s.damage_there) {
    work.host(kHalves * real(s.columns) * real(s.columns), kForcesOfDamage);
    return;
  }
  const double n = real(s.columns + s.grips) + (torn ? kDifferences : 0),
               bytes = n * n * sizeof(double);
  work.submit();
  if (torn) work.pass(2 * bytes, 2 * kRank * n * n);
  work.passes(kProductsThere, kProductsThere * bytes, 2 * kProductsThere * n * n);
}

double ms_of_damage(const FrameRates& rates, Index columns, bool there) {
  FrameShape shape;
  shape.columns = static_cast<std::size_t>(columns);
  shape.damage_there = there;
  FrameWork work(rates);
  forces_of_damage(work, shape, false);
  return work.sum().ms;
}

void condensed_solution(FrameWork& work, const FrameShape& s, bool torn) {
  const double rows = real(s.kept), columns = real(s.touched) + (torn ? kTouched : 0);
  forces_of_damage(work, s, torn);
  if (!s.region_there) {
    work.host(rows * (real(s.loaded + s.grips + s.columns) + (torn ? kTouched : 0)));
    return;
  }
  work.host(rows * real(s.loaded + s.grips));
  work.submit();
  work.pass(rows * columns * sizeof(double), 2 * rows * columns);
  work.pass(2 * rows * sizeof(double));
}

/// The small matrix of the damage.
void small_update(FrameWork& work, const FrameShape& s) {
  work.host(2 * kDifferences * kDifferences + kUpdateOfDamage * real(s.columns) * real(s.columns));
}

// inverse

std::size_t stored_bytes(const Question& q) {
  return q.unknowns() * q.unknowns() * q.inverse_bytes();
}

/// On the host there is to be room to make it.
std::size_t whole_inverse_bytes(const Question& q) {
  return (q.device.rates.apart() ? 1 : 2) * stored_bytes(q);
}

/// The columns of the loads are more to read than two triangular solves (inverse_base.cpp).
bool loads_favour_factor(const Question& q) {
  return loaded_unknowns(q.problem) * q.unknowns() > 2 * q.factor_entries;
}

/// [s] of a device's own inversion: symmetric block Gauss-Jordan updates half of the matrix for
/// every block of columns.
double inversion_seconds(const Question& q) {
  const double n = real(q.unknowns()), steps = n / kInversionColumns;
  const solver::FrameRates& rates = q.device.rates;
  const double work = n * n * n / rates.flops + steps * n * n * kInversionBytes / rates.bytes;
  return work / kOfItsRates;
}

/// Whether the device itself makes an inverse of this size, in time and in half of its memory.
bool inverts_in_time(const Question& q) {
  if (!q.device_inverts() || !(q.device.rates.flops > 0)) return false;
  const double n = real(q.unknowns()), memory = real(q.device.memory);
  const double stored = real(q.inverse_bytes()),
               beside = stored < kInversionBytes ? kInversionBytes : 0;
  return inversion_seconds(q) <= kPreparation && n * n * (stored + beside) <= kOfItsMemory * memory;
}

bool inverse_pays(const Question& q) {
  if (q.unknowns() > kDenseLimit && !inverts_in_time(q)) return false;
  return !q.device.has(Route::factor) || (q.needs.damage && !loads_favour_factor(q));
}

std::string why_inverse(const Question& q) {
  if (q.asked && q.problem.scene().solver.route == Route::automatic) {
    return "update eager was asked for, which route inverse alone has";
  }
  if (q.asked) return asked_for();
  std::string text = unknowns_of(q) + ": the dense inverse takes " + megabytes(stored_bytes(q)) +
                     ", and a frame reads only its loaded and torn columns";
  if (q.unknowns() > kDenseLimit) {
    std::ostringstream seconds;
    seconds << std::setprecision(2) << inversion_seconds(q);
    text += "; by " + std::string(q.device.rates.measured ? "its measured" : "nominal") +
            " rates the device makes it in about " + seconds.str() + " s";
  }
  return text;
}

std::string no_dense_inverse(const Question& q) {
  return unknowns_of(q) + ": a dense inverse would take " + megabytes(stored_bytes(q)) + "; ";
}

/// u = X f by the loaded columns, on a device apart as they are stored.
void stored_columns(FrameWork& work, const FrameShape& s) {
  work.pass(real(s.kept) * real(s.loaded) * real(s.inverse_bytes),
            2 * real(s.kept) * real(s.loaded));
  work.pass(2 * real(s.kept) * sizeof(double));
}

/// u = X f by the columns that loads, grips and damage multiply.
void inverse_solution(FrameWork& work, const FrameShape& s, bool torn) {
  if (!s.eager) forces_of_damage(work, s, torn);
  const double n = real(s.kept), held = real(s.grips) + (torn && !s.eager ? kTouched : 0);
  if (!s.apart) {  // where they are many two solves with the factor take their place
    const double values = n * (real(s.loaded) + held);
    work.host(s.eager ? values : std::min(values, 2 * real(s.entries)));
  } else if (s.eager) {
    stored_columns(work, s);
  } else {
    const bool exact = s.loaded <= s.exact_loads;
    const double values = n * (held + (exact ? real(s.loaded) : 0));
    if (s.host_corrects) {
      work.host(values + 3 * n);
    } else {
      work.pass(values * sizeof(double), 2 * values);
    }
    if (!exact) stored_columns(work, s);
  }
}

/// Of an event, once more by what they lack: products K u, several at once, and a solve for all.
void refined_columns(FrameWork& work, const FrameShape& s) {
  work.product(kTouched / fem::kProductsAtOnce * real(s.elements));
  work.host(2 * real(s.entries), 1, 4 * kTouched * real(s.entries));
}

void inverse_update(FrameWork& work, const FrameShape& s) {
  const double n = real(s.kept), bytes = real(s.inverse_bytes);
  if (s.apart && s.eager) {
    work.submit();  // the block that the event touches
    work.pass(0);
    work.submit();
    work.pass(kTouched * n * bytes);
    work.pass(n * n * bytes, kRank * n * n);  // half of them, read and written
  } else if (s.apart && s.columns_there && s.entries > 0) {
    work.submit();  // new exact columns, there and back
    work.pass(2 * kTouched * n * sizeof(double));
    work.host(2 * kTouched * n);
    if (s.columns_refined) refined_columns(work, s);
  } else if (s.apart && s.entries > 0) {
    // New exact columns, all at once by the host's factor.
    work.host(2 * real(s.entries), 1, 4 * kDifferences * real(s.entries));
    if (s.columns_refined) refined_columns(work, s);
  } else if (s.apart) {
    work.host(2 * kTouched * n);  // from the inverse that it has kept
  } else if (s.eager) {
    work.host(2 * n * n);
  } else {
    small_update(work, s);
  }
}

// factor

std::string why_factor(const Question& q) {
  if (q.asked) return asked_for();
  if (!q.needs.damage) {
    return unknowns_of(q) + " and nothing can be destroyed: two triangular solves a load";
  }
  if (loads_favour_factor(q)) {
    return unknowns_of(q) + ", " + std::to_string(loaded_unknowns(q.problem)) +
           " of them loaded: so many columns of an inverse are more to read than two triangular "
           "solves";
  }
  return no_dense_inverse(q) + "a fracture updates the factor along its elimination path only";
}

/// Forward from the loaded unknowns along their path alone, backward through all of it.
void factor_solution(FrameWork& work, const FrameShape& s, bool) {
  work.host(real(s.load_path + s.entries));
}

void factor_update(FrameWork& work, const FrameShape& s) {
  const double path = real(s.path);
  work.host(path, 1, 2 * kDifferences * path);
}

/// Its matrix is that of the mesh's own nodes.
std::string against_cg(const Question& q) {
  if (!q.needs.split) return {};
  return "route cg has no room for the unknowns which split nodes bring; use route inverse or "
         "factor";
}

// cg: with the host's factor the yardstick; apart from it some hundred iterations a frame.

bool without_factor(const Question& q) { return q.factor_bytes > q.device.memory; }

bool cg_pays(const Question& q) {
  return q.device.has(Route::factor) ? without_factor(q) : q.unknowns() > kDenseLimit;
}

std::string why_cg(const Question& q) {
  if (!without_factor(q)) {
    return q.asked ? asked_for() : no_dense_inverse(q) + "conjugate gradients need none";
  }
  const std::string text = unknowns_of(q) + ": their factor needs " +
                           std::to_string(q.factor_bytes) + " bytes, but " +
                           std::to_string(q.device.memory) +
                           " are free; an incomplete one preconditions conjugate gradients";
  return q.asked ? asked_for(text) : text;
}

void cg_solution(FrameWork& work, const FrameShape& s, bool torn) {
  if (s.apart) {
    work.fields(s, true);
    work.submit();
    work.iterate(s, torn ? iterations_apart(s) : kKnownSteps);
    work.submit();
    return;
  }
  const double iterations = s.entries == 0 ? kIncompleteIterations * std::cbrt(real(s.unknowns))
                            : torn         ? kFractureIterations + 1
                                           : kQuietIterations + 1;
  work.product(iterations * real(s.elements));
  work.host(2 * (s.entries == 0 ? kStiffness * real(s.unknowns) : real(s.entries)), iterations);
}

void no_update(FrameWork&, const FrameShape&) {}

using Updates = RouteRow::Updates;
constexpr std::array<RouteRow, 4> kRoutes = {{
    {Route::condensed, "condensed", Updates::deferred, against_condensed, condensed_bytes,
     condensed_pays, why_condensed, condensed_solution, small_update},
    {Route::inverse, "inverse", Updates::both, nothing, whole_inverse_bytes, inverse_pays,
     why_inverse, inverse_solution, inverse_update},
    {Route::factor, "factor", Updates::deferred, nothing, no_bytes, always, why_factor,
     factor_solution, factor_update},
    {Route::cg, "cg", Updates::none, against_cg, no_bytes, cg_pays, why_cg, cg_solution, no_update},
}};

}  // namespace

std::optional<Index> columns_worth_a_device(const FrameRates& rates) {
  constexpr Index kStep = 64, kMost = 4096;
  for (Index columns = kStep; columns <= kMost; columns += kStep) {
    if (ms_of_damage(rates, columns, true) < ms_of_damage(rates, columns, false)) return columns;
  }
  return {};
}

std::size_t Question::unknowns() const { return static_cast<std::size_t>(problem.dof_count()); }

bool Question::device_inverts() const {
  return device.fp64 && device.inverts_from != kNone && problem.dof_count() >= device.inverts_from;
}

std::size_t Question::inverse_bytes() const {
  return open_precision && device_inverts() ? sizeof(double) : real_bytes;
}

const Region& Question::region() const {
  if (!found) found = region_of(problem, needs);
  return *found;
}

const std::array<RouteRow, 4>& routes() { return kRoutes; }

const RouteRow& row_of(Route route) { return *std::ranges::find(kRoutes, route, &RouteRow::route); }

std::string unknowns_of(const Question& question) {
  return count_of(static_cast<long long>(question.unknowns()), "unknown");
}

}  // namespace sunder::solver
