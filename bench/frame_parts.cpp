// SPDX-License-Identifier: Apache-2.0
// Where a frame with fractures spends its time on a deferred route, part by part: events of 1, 10
// and 100 elements of an intact body; the first frames of a tear, element by element; the last
// frames before a new base, which have the most columns; and those after so many fractures that the
// base is a factor of the damaged body. The parts of the engine are called as the backend calls
// them, on one thread with nothing beside it. Rows "frame_cascade" are frame_cascades.hpp's, rows
// "measures" frame_measures.hpp's, rows "passes" frame_passes.hpp's.
// bench/frames makes the tables of docs/frames.md of all this.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include "body/stiffness_factor.hpp"

#include "body/assembly.hpp"
#include "frame_bases.hpp"
#include "frame_cascades.hpp"
#include "frame_measures.hpp"
#include "frame_passes.hpp"
#include "run_rows.hpp"
#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "solver/frame_cost.hpp"
#include "solver/inverse_base.hpp"
#include "solver/stress_bounds.hpp"
#include "solver/stress_kernel.hpp"
#include "sunder/error.hpp"
#include "tearing_board.hpp"

namespace sunder::bench {
namespace {

enum Part { kForward, kUpdate, kProject, kRefine, kBackward, kStress, kResidual, kSummary, kParts };
constexpr std::array<const char*, kParts> kNames{"forward_us",  "update_us",   "project_us",
                                                 "refine_us",   "backward_us", "stress_us",
                                                 "residual_us", "summary_us"};
using Times = std::array<double, kParts>;

/// Microseconds that a call takes.
double us_of(const std::function<void()>& run) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  run();
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

/// Passes everything on and takes the time of what a frame asks for.
class TimedBase final : public solver::Base {
 public:
  TimedBase(std::unique_ptr<solver::Base> base, Times& times)
      : base_(std::move(base)), times_(times) {}
  [[nodiscard]] Index size() const override { return base_->size(); }
  void make_room() override { base_->make_room(); }
  void push(std::span<const solver::Difference> vectors, linear_algebra::RowMajor& gram) override {
    times_[kForward] += us_of([&] { base_->push(vectors, gram); });
  }
  void pop() override { base_->pop(); }
  const Eigen::VectorXd& load(const solver::Forces& forces) override {
    const Eigen::VectorXd* projected = nullptr;
    times_[kProject] += us_of([&] { projected = &base_->load(forces); });
    return *projected;
  }
  void expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) override {
    times_[kBackward] += us_of([&] { base_->expand(c, u); });
  }
  [[nodiscard]] std::vector<BufferPlan> buffers() const override { return base_->buffers(); }

 private:
  std::unique_ptr<solver::Base> base_;
  Times& times_;
};

/// Frames of a board torn one element after the other.
class Frames {
 public:
  /// `before` fractures are in the base.
  Frames(const TearingBoard& board, std::size_t before, bool inverse)
      : board_(board), problem_(*board.problem), next_(before), kernel_(board.problem, {}, 1) {
    std::vector<double> scale(problem_.mesh().tets.size(), 1.0);
    for (Index e : board.connected(before)) scale[e] = problem_.scene().fracture.alpha;
    factor_.emplace(fem::factor_stiffness(problem_, scale));
    std::unique_ptr<solver::Base> base;
    if (inverse) {
      base = std::make_unique<solver::InverseBase>(*factor_);
    } else {
      base = std::make_unique<solver::FactorBase>(*factor_);
    }
    deferred_.emplace(problem_, std::make_unique<TimedBase>(std::move(base), times_));
    kernel_.keep_bounds();
    kernel_.keep_forces();
    kernel_.destroy(board.connected(before));
    nodal_.assign(problem_.dofs().size(), 0.0);
    forces_ = nodal_;
    stress_.resize(scale.size());
    excluded_.assign(scale.size(), 0);
    f_.setZero(problem_.dof_count());
    for (std::size_t i = 0; i < board.load_dofs.size(); ++i) {
      f_[board.load_dofs[i]] = board.load_values[i];
    }
    product_.setZero(f_.size());
    of_energy_ = solver::largest_stress_of_energy(problem_);
    solve(0);
  }

  void destroy(std::size_t count) {
    next_ += count;
    const std::span<const Index> elements = board_.connected(next_).last(count);
    const double forward = times_[kForward];
    times_[kUpdate] += us_of([&] {
      kernel_.destroy(elements);
      if (!deferred_->destroy(elements)) throw NumericalError("not definite");
    });
    times_[kUpdate] -= times_[kForward] - forward;
  }

  /// The next event with its frame.
  Times frame(std::size_t elements) {
    times_ = {};
    destroy(elements);
    // What a frame is content with (frame_check.hpp).
    const double e = 1e-5 * largest_ / of_energy_;
    solve(e * e);
    times_[kSummary] +=
        us_of([&] { benchmark::DoNotOptimize(kernel_.summarize(excluded_, stress_)); });
    return times_;
  }
  [[nodiscard]] Index columns() const { return deferred_->rank(); }
  [[nodiscard]] double megabytes() const { return 1e-6 * static_cast<double>(factor_->bytes()); }

 private:
  void solve(double energy_tolerance) {
    const double base = times_[kProject] + times_[kBackward];
    times_[kRefine] += us_of([&] {
      deferred_->solve({board_.load_dofs, board_.load_values}, {}, u_, energy_tolerance);
    });
    times_[kRefine] -= times_[kProject] + times_[kBackward] - base;
    times_[kStress] += us_of([&] {
      fem::scatter(problem_, {u_.data(), static_cast<std::size_t>(u_.size())}, nodal_);
      largest_ = kernel_.run(nodal_, stress_);
    });
    times_[kResidual] += us_of([&] {
      kernel_.nodal_forces(forces_);
      fem::gather(problem_, forces_, {product_.data(), static_cast<std::size_t>(product_.size())});
      benchmark::DoNotOptimize((f_ - product_).norm());
    });
  }

  const TearingBoard& board_;
  const Problem& problem_;
  std::size_t next_;
  std::optional<linear_algebra::Factor> factor_;
  Times times_{};
  std::optional<solver::Deferred> deferred_;
  solver::StressKernel kernel_;
  std::vector<double> nodal_, forces_;
  std::vector<Voigt> stress_;
  std::vector<std::uint8_t> excluded_;
  Eigen::VectorXd u_, f_, product_;
  double largest_ = 0, of_energy_ = 0;
};

const TearingBoard& board_of(Index cells) {
  static std::map<Index, std::unique_ptr<TearingBoard>> boards;
  auto& board = boards[cells];
  if (!board) board = std::make_unique<TearingBoard>(cells);
  return *board;
}

/// Fractures that a base serves, one by one, until the next one is taken: half of them until it is
/// asked for (deferred_route.cpp).
std::size_t frames_of_a_base(Index cells) {
  const TearingBoard& board = board_of(cells);
  const linear_algebra::Factor factor = fem::factor_stiffness(*board.problem);
  return 2 * static_cast<std::size_t>(
                 solver::frames_of_a_factor(factor.cholesky(), board.problem->mesh().tets.size()));
}

/// Which frames: `before` fractures in the base, `over` it, and then `count` frames that are
/// measured, of so many elements each.
struct Which {
  const char* name;
  bool inverse;
  std::size_t before, over, count, elements = 1;
  bool up_to_the_next = false;  ///< `over`: all but the last frames that a base serves
};

/// Least time of each part of each frame, averaged over the frames.
void parts(benchmark::State& state, Index cells, Which which) {
  std::vector<Times> least(which.count);
  for (Times& t : least) t.fill(std::numeric_limits<double>::infinity());
  double columns = 0, megabytes = 0;
  for (auto _ : state) {
    Frames frames(board_of(cells), which.before, which.inverse);
    for (std::size_t i = 0; i < which.over; ++i) frames.destroy(1);
    columns = megabytes = 0;
    for (Times& t : least) {
      const Times now = frames.frame(which.elements);
      for (std::size_t p = 0; p < kParts; ++p) t[p] = std::min(t[p], now[p]);
      columns += frames.columns() / static_cast<double>(which.count);
    }
    megabytes = frames.megabytes();
  }
  double all = 0;
  for (std::size_t p = 0; p < kParts; ++p) {
    double sum = 0;
    for (const Times& t : least) sum += t[p] / static_cast<double>(which.count);
    state.counters[kNames[p]] = sum;
    all += sum;
  }
  state.counters["all_us"] = all;
  state.counters["columns"] = columns;
  state.counters["factor_MB"] = megabytes;
}

}  // namespace
}  // namespace sunder::bench

namespace sunder::bench {
namespace {

void add(Index cells, const Which& which) {
  const std::string name =
      std::string("frame_parts/") + which.name + "/" + std::to_string(6 * cells * cells);
  benchmark::RegisterBenchmark(name.c_str(),
                               [=](benchmark::State& s) {
                                 Which own = which;
                                 if (own.up_to_the_next) {
                                   own.over = frames_of_a_base(cells) - own.count;
                                 }
                                 parts(s, cells, own);
                               })
      ->Iterations(cells > 71                    ? 3
                   : which.inverse && cells > 18 ? 2
                                                 : 10)
      ->Unit(benchmark::kMillisecond);
}

void register_rows() {
  for (Index cells : {18, 36, 71, 141}) {
    if (cells <= 36) add(cells, {"inverse_first", true, 0, 0, 5});
    add(cells, {"factor_first", false, 0, 0, 5});
    add(cells, {"factor_fullest", false, 0, 0, 16, 1, true});
    add(cells, {"after_640", false, 544, 48, 48});
    const auto unknowns = static_cast<std::size_t>(board_of(cells).problem->dof_count());
    for (const auto& [name, elements] :
         {std::pair{"event_1", 1}, {"event_10", 10}, {"event_100", 100}}) {
      const auto count = static_cast<std::size_t>(elements);
      if (!solver::takes_new_factor(unknowns, count)) {
        add(cells, {name, false, 0, 0, 1, count});
      }
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  sunder::bench::register_rows();
  sunder::bench::register_bases();
  sunder::bench::register_cascades();
  sunder::bench::register_measures();
  sunder::bench::register_passes();
  return sunder::bench::run_rows(argc, argv);
}
