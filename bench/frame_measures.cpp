// SPDX-License-Identifier: Apache-2.0
#include "frame_measures.hpp"

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "body/assembly.hpp"
#include "body/stiffness_factor.hpp"
#include "solver/stress_kernel.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

/// Least microseconds of a call.
class Least {
 public:
  void time(const std::function<void()>& run) {
    const auto start = Clock::now();
    run();
    us_ = std::min(us_, std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  [[nodiscard]] double us() const { return us_; }

 private:
  using Clock = std::chrono::steady_clock;
  double us_ = std::numeric_limits<double>::infinity();
};

/// A field by name, at all nodes, and the elements that are gone in it. The uniform ones are those
/// where no element stands out: no bound excludes another.
struct Field {
  std::vector<double> u;
  std::span<const Index> destroyed;
};

std::vector<double> uniform(const Problem& problem, const Mat3& gradient) {
  std::vector<double> u;
  for (const Vec3& x : problem.mesh().nodes) {
    const Vec3 at = gradient * x;
    u.insert(u.end(), at.begin(), at.end());
  }
  return u;
}

/// The board under its load with `count` elements torn.
std::vector<double> pulled(const TearingBoard& board, std::size_t count) {
  const Problem& problem = *board.problem;
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  for (Index e : board.connected(count)) scale[e] = problem.scene().fracture.alpha;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(problem.dof_count());
  for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
    f[board.load_dofs[i]] = board.load_values[i];
  }
  const Eigen::VectorXd solution = fem::factor_stiffness(problem, scale).solve(f);
  std::vector<double> u(problem.dofs().size());
  fem::scatter(problem, {solution.data(), static_cast<std::size_t>(solution.size())}, u);
  return u;
}

Field field(const TearingBoard& board, const std::string& name) {
  constexpr std::size_t kTorn = 20;
  if (name == "pulled") return {pulled(board, 0), {}};
  if (name == "torn") return {pulled(board, kTorn), board.connected(kTorn)};
  Mat3 gradient = Mat3::Zero();
  if (name == "stretched") gradient.diagonal() = 0.1 * Vec3(1, -0.4, -0.4);
  if (name == "sheared") gradient(0, 1) = 0.1;
  if (name == "turned") {
    gradient = Eigen::AngleAxisd(std::numbers::pi / 6, Vec3::UnitZ()).matrix() - Mat3::Identity();
  }
  return {uniform(*board.problem, gradient), {}};
}

void measures(benchmark::State& state, Index cells, const std::string& name) {
  const TearingBoard board(cells);
  const Field of = field(board, name);
  // As a frame has them: bounds of the ratios in both, what the measures read in one.
  solver::StressKernel plain(board.problem, {}, 1), measured(board.problem, {}, 1);
  measured.keep_deformation();
  for (solver::StressKernel* kernel : {&plain, &measured}) {
    kernel->keep_bounds();
    kernel->destroy(of.destroyed);
  }
  std::vector<Voigt> stress(board.problem->mesh().tets.size());
  Least without, with, search;
  for (auto _ : state) {
    without.time([&] { benchmark::DoNotOptimize(plain.run(of.u, stress)); });
    with.time([&] { benchmark::DoNotOptimize(measured.run(of.u, stress)); });
    search.time([&] { benchmark::DoNotOptimize(measured.deformation(of.u)); });
  }
  state.counters["pass_us"] = without.us();
  state.counters["bounds_us"] = with.us() - without.us();
  state.counters["search_us"] = search.us();
  state.counters["share"] = (with.us() - without.us() + search.us()) / without.us();
}

}  // namespace

void register_measures() {
  for (const char* name : {"pulled", "torn", "stretched", "sheared", "turned"}) {
    for (Index cells : {18, 36, 71}) {
      const std::string row =
          std::string("measures/") + name + "/" + std::to_string(6 * cells * cells);
      benchmark::RegisterBenchmark(row.c_str(), [=](auto& s) { measures(s, cells, name); })
          ->Iterations(cells > 36 ? 1000 : 5000)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

}  // namespace sunder::bench
