// SPDX-License-Identifier: Apache-2.0
#include "solver/plan.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

#include "solver/route_table.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::solver {
namespace {

// Bytes of an element while its stiffness goes into the matrix: at most 28 entries of 12, and lists
// of the nodes around each node. Where it pools its volume: some 48 entries of its patch in a list
// with row and column, and again in a matrix.
constexpr std::size_t kAssembly = 28 * 12 + 32, kPooled = 48 * (16 + 12);
// And then of all else that a frame holds: shapes, stress, the matrix and its incomplete factor.
constexpr std::size_t kElement = 800;

// What the mixed recipe holds with fp32 storage (docs/method.md "Stability"); below it only fp64.
constexpr double kFp32Tolerance = 1e-4;
// Past these the displacement handed out in fp32 alone costs a stiff element more than that
// (bench_stability, verdict "rounded").
constexpr double kFp32Contrast = 1e3, kFp32Poisson = 0.4999;
// Of pooled volume: at .4999 and a contrast of 100 the estimate misses 50 fractures along a crack,
// whose stress is 2.3e-4 off (bench_stability); at .499 all are right.
constexpr double kFp32PooledPoisson = 0.499;

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// The factor, and what exists beside it in a long tear: that of a damaged body while a newer one
/// is made. The stiffness: in the factor's order, and once more on the way there.
std::size_t factor_bytes(const fem::Analysis& analysis, const Needs& needs) {
  const std::size_t factors = needs.damage ? 3 : 1;
  return factors * analysis.entries() * sizeof(double) +
         2 * static_cast<std::size_t>(analysis.ordered.nonZeros()) *
             (sizeof(double) + sizeof(Index));
}

/// "inverse, condensed and cg".
std::string list_of(const std::vector<Route>& routes) {
  std::string list;
  for (const Route& route : routes) {
    if (!list.empty()) list += &route == &routes.back() ? " and " : ", ";
    list += name_of(route);
  }
  return list;
}

/// What the options ask of any scene.
void check_options(const SolverOptions& solver, const PlanDevice& device) {
  if (solver.precision == Precision::fp32 && !device.fp32) {
    throw DeviceError("backend " + device.backend +
                      " computes in fp64 only; use precision fp64 or auto");
  }
  if (solver.route != Route::automatic && !device.has(solver.route)) {
    throw DeviceError("backend " + device.backend + " offers the routes " + list_of(device.routes) +
                      "; choose one, auto or backend cpu");
  }
  using Updates = RouteRow::Updates;
  const Updates updates =
      solver.route == Route::automatic ? Updates::both : row_of(solver.route).updates;
  if (updates == Updates::none && solver.update != Update::automatic) {
    throw DeviceError("route " + name_of(solver.route) +
                      " has no update to choose; use update auto, or route inverse");
  }
  const bool eager = solver.update == Update::eager;
  if (updates == Updates::deferred && eager) {
    throw DeviceError("route " + name_of(solver.route) +
                      " has the update deferred only; use update deferred or auto, or route "
                      "inverse, which update eager writes over");
  }
  if (eager && solver.precision == Precision::fp32) {
    throw DeviceError(
        "update eager has precision fp64 only, since a crack destroys an inverse in fp32 that "
        "events write over (docs/method.md \"Stability\"); use precision fp64 or auto, or update "
        "deferred");
  }
}

/// What cracks that split ask of an update.
void check_split(const Needs& needs, const SolverOptions& solver) {
  if (!needs.split) return;
  if (solver.update == Update::eager) {
    throw DeviceError(
        "update eager writes over an inverse that has no room for the unknowns which split nodes "
        "bring; use update deferred or auto");
  }
}

/// The largest of what pools its volume; 0: nothing does.
double pooled_poisson(const Problem& problem) {
  double most = 0;
  for (Index e = 0; problem.pools() && e < problem.tet_count(); ++e) {
    if (problem.material(e).volume != MaterialVolume::pooled) continue;
    most = std::max(most, problem.small_strain(e).poisson);
  }
  return most;
}

/// What patches of pooled volume ask of a device.
void check_pools(const Problem& problem, const PlanDevice& device) {
  if (!problem.pools() || device.backend != "vulkan") return;
  if (problem.scene().solver.update == Update::eager) {
    throw DeviceError(
        "update eager on backend vulkan writes over an inverse element by element and does not "
        "compute pooled volume (volume = \"pooled\"); use update deferred or auto, or backend cpu");
  }
  const double poisson = pooled_poisson(problem);
  if (problem.scene().solver.precision == Precision::fp32 && poisson > kFp32PooledPoisson) {
    std::ostringstream ratio;
    ratio << std::setprecision(8) << poisson;
    throw DeviceError(
        "precision fp32 does not keep its promise for pooled volume at a Poisson's ratio of " +
        ratio.str() + ", over " + number(kFp32PooledPoisson) + "; use precision fp64 or auto");
  }
}

[[noreturn]] void refuse(const std::string& what, std::size_t needed, const Question& q,
                         const std::string& instead) {
  const std::string needs =
      what + " needs " + std::to_string(needed) + " bytes for " + unknowns_of(q) + ", but ";
  const std::string memory = std::to_string(q.device.memory);
  if (!q.device.rates.apart()) {
    throw InputError(InputFault::too_large, needs + memory + " are free; " + instead);
  }
  throw DeviceError(needs + "the device \"" + q.device.name + "\" has " + memory + "; " + instead);
}

void require(const RouteRow& row, const Question& q) {
  const std::size_t needed = row.bytes(q);
  if (needed <= q.device.memory) return;
  refuse("route " + std::string(row.name), needed, q,
         q.device.has(Route::factor) ? "use route factor" : "use route cg");
}

/// Counts what all routes of a host are made by, before it is computed.
std::shared_ptr<const fem::Analysis> analyse(Question& q) {
  std::size_t least = static_cast<std::size_t>(q.problem.tet_count()) * (kAssembly + kElement);
  for (Index e = 0; q.problem.pools() && e < q.problem.tet_count(); ++e) {
    if (q.problem.material(e).volume == MaterialVolume::pooled) least += kPooled;
  }
  if (least > q.device.memory) {
    refuse("even route cg", least, q, "use a coarser mesh or a larger machine");
  }
  std::shared_ptr<const fem::Analysis> analysis =
      q.device.analysis ? q.device.analysis() : fem::analyse(q.problem);
  q.factor_entries = analysis->entries();
  q.factor_bytes = factor_bytes(*analysis, q.needs);
  return analysis;
}

/// Of the rows that pay the first that fits.
const RouteRow& choose(const Question& q) {
  const RouteRow* too_large = nullptr;
  for (const RouteRow& row : routes()) {
    if (!q.device.has(row.route) || !row.pays(q) || !row.against(q).empty()) continue;
    const std::size_t factor = row.route == Route::cg ? 0 : q.factor_bytes;
    if (factor + row.bytes(q) <= q.device.memory) return row;
    if (!too_large) too_large = &row;
  }
  require(*too_large, q);
  return *too_large;
}

/// What of the materials is past kFp32Contrast and kFp32Poisson; empty: nothing.
std::string past_fp32(const Problem& problem) {
  double softest = problem.small_strain(0).young, stiffest = softest, poisson = 0;
  const double pooled = pooled_poisson(problem);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    softest = std::min(softest, problem.small_strain(e).young);
    stiffest = std::max(stiffest, problem.small_strain(e).young);
    poisson = std::max(poisson, problem.small_strain(e).poisson);
  }
  if (stiffest / softest > kFp32Contrast) {
    return "Young's moduli differ by a factor of " + number(stiffest / softest) + ", more than " +
           number(kFp32Contrast);
  }
  if (poisson > kFp32Poisson) {
    std::ostringstream out;
    out << std::setprecision(8) << poisson;
    return "Poisson's ratio is " + out.str() + ", more than " + number(kFp32Poisson);
  }
  if (pooled > kFp32PooledPoisson) {
    std::ostringstream out;
    out << std::setprecision(8) << pooled;
    return "Poisson's ratio of pooled volume is " + out.str() + ", more than " +
           number(kFp32PooledPoisson);
  }
  return {};
}

/// In what precision a device stores that has fp32, with sums in fp64 or, without its own, on the
/// host. Returns why.
std::string choose_precision(const Problem& problem, const PlanDevice& device, Plan& plan) {
  const SolverOptions& solver = problem.scene().solver;
  const bool open = solver.precision == Precision::automatic;
  plan.fp64 = plan.eager || solver.precision == Precision::fp64 ||
              (open && !(solver.tolerance >= kFp32Tolerance));
  const std::string past = plan.fp64 ? "" : past_fp32(problem);
  const bool stiff = !past.empty() && open && device.fp64;
  plan.fp64 = plan.fp64 || stiff;
  if (!past.empty() && !plan.fp64) {
    plan.warnings.push_back(
        past + ": displacement handed out in fp32 alone can cost stress more than " +
        number(kFp32Tolerance) + " of its largest value; use " +
        (device.fp64 ? "precision fp64 or auto" : "a device with shaderFloat64 or backend cpu"));
  }
  if (!open) {
    return std::string(plan.fp64 ? "fp64 was asked for" : "fp32 storage was asked for") +
           (past.empty() ? "" : ", though these materials need fp64");
  }
  if (plan.eager) return "the update eager needs fp64";
  if (stiff) {
    return "these materials need fp64: contrast over 1000, or Poisson's ratio over 0.4999 (of "
           "pooled "
           "volume 0.499)";
  }
  return "tolerance " + number(solver.tolerance) +
         (plan.fp64 ? " needs fp64" : " is kept by fp32 storage with fp64 sums");
}

/// What a device cannot do that does not compute in fp64.
void require_double(const Plan& plan, const SolverOptions& solver, const PlanDevice& device) {
  const auto refuse = [&](const std::string& what) {
    throw DeviceError(
        what + ", but the device \"" + device.name +
        "\" lacks shaderFloat64; use route inverse or condensed with update deferred and a "
        "tolerance of 1e-4 or more, another device or backend cpu");
  };
  if (plan.eager) refuse("the update eager needs fp64");
  if (plan.fp64) {
    refuse(solver.precision == Precision::fp64
               ? "precision fp64 was asked for"
               : "tolerance " + number(solver.tolerance) + " needs fp64");
  }
  if (plan.route == Route::cg) refuse("route cg sums in fp64");
}

}  // namespace

bool PlanDevice::has(Route route) const { return std::ranges::find(routes, route) != routes.end(); }

Plan make_plan(const Problem& problem, const Needs& needs, const PlanDevice& device) {
  const SolverOptions& solver = problem.scene().solver;
  check_options(solver, device);
  check_split(needs, solver);
  check_pools(problem, device);
  Plan plan;
  plan.eager = solver.update == Update::eager;
  const std::string precision = device.fp32 ? choose_precision(problem, device, plan) : "";
  Question q{problem, needs, device};
  q.real_bytes = plan.fp64 ? 8 : 4;
  q.open_precision = solver.precision == Precision::automatic;
  q.asked = solver.route != Route::automatic || plan.eager;
  const RouteRow* row = nullptr;
  if (q.asked) {
    row = &row_of(plan.eager ? Route::inverse : solver.route);
    if (const std::string reason = row->against(q); !reason.empty()) throw DeviceError(reason);
    require(*row, q);
  }
  if (device.has(Route::factor)) {
    plan.analysis = analyse(q);
    if (q.factor_bytes > device.memory) plan.analysis.reset();
  }
  if (!row) row = &choose(q);
  plan.route = row->route;
  if (!plan.analysis && device.has(Route::factor) && plan.route != Route::cg) {
    refuse("the factor of route " + name_of(plan.route), q.factor_bytes, q, "use route cg");
  }
  plan.why = row->why(q);
  if (!precision.empty()) plan.why += "; " + precision;
  if (!device.fp64) {
    require_double(plan, solver, device);
    plan.why += "; the device lacks shaderFloat64, so the host corrects for the damage";
  }
  if (plan.route == Route::condensed) {
    plan.left_out = left_out_of(problem, q.region());
    plan.region = std::move(q.found);
  }
  plan.invert_on_device = plan.route == Route::inverse && q.device_inverts();
  plan.exact_inverse = plan.invert_on_device && q.inverse_bytes() == sizeof(double);
  if (plan.invert_on_device) plan.why += "; the device computes the inverse";
  if (plan.exact_inverse && !plan.fp64) plan.why += " and keeps it in fp64";
  return plan;
}

FrameShape Plan::shape(const Problem& problem, const Needs& needs) const {
  FrameShape shape;
  shape.route = route;
  shape.eager = eager;
  shape.damage = needs.damage;
  shape.unknowns = static_cast<std::size_t>(problem.dof_count());
  shape.kept = region ? region->dofs.size() : shape.unknowns;
  shape.grips = problem.gripped_dofs().size();
  shape.loaded = loaded_unknowns(problem);
  shape.loaded -= std::min(shape.loaded, shape.grips);
  shape.elements = problem.mesh().tets.size();
  return shape;
}

std::string name_of(Route route) { return route == Route::automatic ? "auto" : row_of(route).name; }

std::string name_of_update(const Plan& plan) {
  if (row_of(plan.route).updates == RouteRow::Updates::none) return "matrix";
  return plan.eager ? "eager" : "deferred";
}

}  // namespace sunder::solver
