// SPDX-License-Identifier: Apache-2.0
// Peeling beside theory: strips off a rigid bed at 90 and 180 degrees, T-peel, double cantilever
// (tests/verification/peeling_cases.hpp), each on three meshes by four steps of the grip while the
// edge moves on by a cell, and on the coarsest one by other steps. Counters of a row, over the
// steady part: force per width over that of rigid strips and over that of strips that stretch
// (mean, least, largest), work of the grip less the stored energy and energy of the parted pairs,
// both over G_c times the area parted. Its time is that of all of the way.
#include <benchmark/benchmark.h>

#include <string>

#include "run_rows.hpp"
#include "verification/peeling_cases.hpp"

namespace sunder::bench {
namespace {

void peeling_row(benchmark::State& state, test::Peel peel, Index finer, double per_cell) {
  for (auto _ : state) {
    const test::PeelFigures of = test::peel(peel, finer, per_cell);
    state.SetIterationTime(1e-3 * of.ms);
    state.counters["tets"] = of.tets;
    state.counters["over_rigid"] = of.over_rigid;
    state.counters["mean"] = of.mean;
    state.counters["least"] = of.least;
    state.counters["largest"] = of.largest;
    state.counters["work"] = of.work;
    state.counters["parted"] = of.parted;
    state.counters["rows"] = of.rows;
  }
}

std::string in_digits(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

void add_row(test::Peel peel, Index finer, double per_cell) {
  const std::string name = "peeling/" + test::name_of(peel) + "/" +
                           in_digits(test::coarse_cell(peel) / finer) + " mm/" +
                           in_digits(per_cell) + " steps a cell";
  benchmark::RegisterBenchmark(
      name.c_str(), [=](benchmark::State& state) { peeling_row(state, peel, finer, per_cell); })
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  using namespace sunder;
  for (const test::Peel peel : test::kPeels) {
    for (const Index finer : {1, 2, 4}) bench::add_row(peel, finer, 4);
    for (const double per_cell : {0.5, 1.0, 2.0, 16.0, 64.0}) bench::add_row(peel, 1, per_cell);
  }
  return bench::run_rows(argc, argv);
}
