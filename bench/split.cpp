// SPDX-License-Identifier: Apache-2.0
// Cracks that split beside cracks that destroy elements: the same straight tear through the same
// board, one advance an event, on the factor and one thread. Of the n-th advance: the event (the
// update of the small matrix, its border and, where an inverse is there, columns of it), the frame
// (event and the solution of a load that is new to it), and the touched unknowns after it: what
// later frames pay by.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "body/stiffness_factor.hpp"
#include "fracture/split/split_front.hpp"
#include "run_rows.hpp"
#include "solver/deferred.hpp"
#include "solver/factor_base.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {
namespace {

using Clock = std::chrono::steady_clock;

// 30,240 tetrahedra in two layers, long enough for a hundred advances.
constexpr test::BoardShape kShape{140, 18, 2, 140, 18, 2};

Scene scene_of() {
  Scene scene;
  scene.mesh = test::structured_board(kShape);
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, kShape.height - 1e-9, -1), Vec3(1e9, 1e9, 1e9)}, Axes{7}});
  scene.fracture.model = FractureModel::b;
  scene.fracture.crack = CrackWay::split;
  return scene;
}

struct Torn {
  Torn() : problem(std::make_shared<const Problem>(scene_of())) {
    factor = std::make_unique<linear_algebra::Factor>(fem::factor_stiffness(*problem));
    for (Index n = 0; n < problem->node_count(); ++n) {
      const Vec3& x = problem->mesh().nodes[static_cast<std::size_t>(n)];
      if (x.y() < 1e-9 && x.x() < 10) dofs.push_back(problem->dof(n, 1));
    }
    values.assign(dofs.size(), -1.0);
  }
  std::shared_ptr<const Problem> problem;
  std::unique_ptr<linear_algebra::Factor> factor;
  std::vector<Index> dofs;
  std::vector<double> values;
};

const Torn& torn() {
  static const Torn torn;
  return torn;
}

/// The advances of a crack from the middle of the left side, h each.
std::vector<fem::Change> splits(std::size_t count) {
  const Problem& problem = *torn().problem;
  const fracture::Board board(problem.mesh(), {});
  fracture::SplitBody body(problem);
  fracture::SplitFront front(board, problem, body);
  const std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  const auto parts = [](Index, Index) { return true; };
  const Vec2 mouth = board.plane().project(Vec3(0, kShape.height / 2, 0));
  const Vec2 d = board.plane().project(Vec3(1, 0, 0));
  Crack crack;
  crack.kind = CrackKind::edge;
  crack.mouth = mouth;
  crack.path = {mouth, mouth + 1.5 * board.h() * d};
  crack.length = 1.5 * board.h();
  crack.tips = {{crack.path.back(), d, false}};
  fracture::SplitCrack split;
  Index first = 0;
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const auto away = [&](Index of) { return (board.centroid(of) - mouth).norm(); };
    if (away(e) < away(first)) first = e;
  }
  std::vector<fem::Change> all{front.bear(crack, split, first, destroyed, parts).change};
  while (all.size() < count) {
    all.push_back(front.advance(crack, split, 0, d, board.h(), destroyed, parts).change);
  }
  for (fem::Change& change : all) change.held = true;
  return all;
}

/// As far each time as a split goes: elements of the row below mid-height, by their centroids.
std::vector<fem::Change> losses(std::size_t count) {
  const Problem& problem = *torn().problem;
  const fracture::Board board(problem.mesh(), {});
  std::vector<fem::Change> all(count);
  for (Index e = 0; e < problem.tet_count(); ++e) {
    const Vec3 at = board.plane().lift(board.centroid(e));
    if (!(at.y() > kShape.height / 2 - 1 && at.y() < kShape.height / 2)) continue;
    const auto advance = static_cast<std::size_t>(at.x() / board.h());
    if (advance < count) all[advance].leave.push_back(e);
  }
  return all;
}

bool follow(solver::Deferred& deferred, const fem::Change& change) {
  return deferred.follow(change);
}

void row(benchmark::State& state, bool split, std::size_t count) {
  const auto events = split ? splits(count) : losses(count);
  solver::Deferred deferred(*torn().problem, std::make_unique<solver::FactorBase>(*torn().factor));
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (!follow(deferred, events[i])) return state.SkipWithError("an event was refused");
  }
  std::vector<double> of_event, of_frame;
  std::vector<double> values = torn().values;
  Eigen::VectorXd u;
  Index touched = 0;
  for (auto _ : state) {
    for (double& f : values) f = -f;  // new to the event
    const auto start = Clock::now();
    const bool followed = follow(deferred, events[count - 1]);
    const auto between = Clock::now();
    deferred.solve({torn().dofs, values}, {}, u);
    const auto end = Clock::now();
    if (!followed) return state.SkipWithError("an event was refused");
    of_event.push_back(std::chrono::duration<double, std::milli>(between - start).count());
    of_frame.push_back(std::chrono::duration<double, std::milli>(end - start).count());
    state.SetIterationTime(of_frame.back() / 1e3);
    touched = deferred.rank() + static_cast<Index>(deferred.offsets().size());
    deferred.take_back();
  }
  const auto median = [](std::vector<double>& of) {
    std::sort(of.begin(), of.end());
    return of[of.size() / 2];
  };
  state.counters["median_ms"] = median(of_frame);
  state.counters["event_ms"] = median(of_event);
  state.counters["touched"] = touched;
}

void register_rows() {
  for (const bool split : {false, true}) {
    for (const std::size_t count : {1U, 10U, 50U, 100U}) {
      const std::string name =
          std::string("tear/") + (split ? "split/" : "destroyed/") + "k" + std::to_string(count);
      benchmark::RegisterBenchmark(name.c_str(), row, split, count)
          ->UseManualTime()
          ->Iterations(11)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  sunder::bench::register_rows();
  return sunder::bench::run_rows(argc, argv);
}
