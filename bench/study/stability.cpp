// SPDX-License-Identifier: Apache-2.0
// The stability study: one difficulty at a time, then pairs, every method; one CSV row per cell.
//   bench_stability FILE [quick|full|many|pooled]
// quick: one difficulty at a time; full: the pairs as well; many: 640 fractures; pooled: those
// cells of full whose volume is pooled. bench/run judges the others by the table of accuracy
// (suite/accuracy.py).
// Exit code 1 when a cell is WRONG: a number that is off, or no number, and nothing said.
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>

#include "bench/study/board.hpp"
#include "bench/study/method.hpp"
#include "sunder/backends.hpp"

namespace sunder::bench {
namespace {

struct Cell {
  std::string study;
  Difficulty difficulty;
  std::size_t batch = 10;  ///< elements an event
};

using Set = std::function<void(Difficulty&, double)>;
struct Knob {
  std::string name;
  Set set;
  std::vector<double> values;
};

Knob contrast() {
  return {"contrast", [](auto& d, double v) { d.contrast = v; }, {1, 10, 1e2, 1e3, 1e4, 1e5, 1e6}};
}
Knob poisson() {
  return {"nu", [](auto& d, double v) { d.poisson = v; }, {0, .25, .4, .49, .499, .4999, .49999}};
}
Knob sliver() {
  return {"sliver", [](auto& d, double v) { d.sliver = v; }, {1, 1e-1, 1e-2, 1e-3, 1e-4}};
}
Knob alpha() {
  return {"alpha",
          [](auto& d, double v) { d.alpha = v; },
          {1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12}};
}
Knob unit() {
  return {"unit", [](auto& d, double v) { d.unit = v; }, {1e-6, 1e-3, 1, 1e3, 1e6}};
}
Knob crack() {
  return {
      "crack", [](auto& d, double v) { d.fractures = static_cast<int>(v); }, {1, 10, 50, 100, 200}};
}

void one_at_a_time(std::vector<Cell>& cells) {
  for (const Knob& knob : {contrast(), poisson(), sliver(), alpha(), unit(), crack()}) {
    for (double v : knob.values) {
      Cell cell{knob.name, {}};
      knob.set(cell.difficulty, v);
      cells.push_back(cell);
    }
  }
  for (int count : {1, 10, 50, 100, 200}) {
    Cell cell{"scattered", {}};
    cell.difficulty.pattern = "scattered";
    cell.difficulty.fractures = count;
    cells.push_back(cell);
  }
  for (const char* pattern : {"cut", "island", "bridge"}) {
    Cell cell{pattern, {}};
    cell.difficulty.pattern = pattern;
    cells.push_back(cell);
  }
  for (const char* pattern : {"crack", "scattered"}) {
    for (std::size_t batch : {1, 10, 100}) {
      Cell cell{std::string(pattern) == "crack" ? "batch" : "scattered batch", {}, batch};
      cell.difficulty.pattern = pattern;
      cell.difficulty.fractures = 200;
      cells.push_back(cell);
    }
  }
}

/// Volume pooled over patches: what is hard for it alone, then with nearly incompressible tissue.
void pooled(std::vector<Cell>& cells, bool full) {
  const auto add = [&](const std::string& study, const Difficulty& difficulty) {
    cells.push_back({"pooled " + study, difficulty});
    cells.back().difficulty.pooled = true;
  };
  for (double nu : {.4, .49, .499, .4999}) {
    if (!full && nu == .4) continue;
    Difficulty own;
    own.poisson = nu;
    for (const Knob& knob : {contrast(), sliver(), alpha(), crack()}) {
      for (std::size_t i = 0; i < knob.values.size(); ++i) {
        // Each by itself takes the ends and the middle.
        const bool end = i == 0 || i + 1 == knob.values.size() || i == knob.values.size() / 2;
        Difficulty difficulty = own;
        knob.set(difficulty, knob.values[i]);
        if (full || end) add("nu x " + knob.name, difficulty);
      }
    }
    for (const char* pattern : {"scattered", "cut", "island", "bridge"}) {
      Difficulty difficulty = own;
      difficulty.pattern = pattern;
      if (difficulty.pattern == "scattered") difficulty.fractures = 200;
      add(pattern, difficulty);
    }
  }
}

/// Accumulated fractures past what one layer of cells can lose.
void many_fractures(std::vector<Cell>& cells) {
  for (const char* pattern : {"crack", "scattered"}) {
    Cell cell{pattern, {}};
    cell.difficulty.pattern = pattern;
    cell.difficulty.fractures = 640;
    cell.difficulty.layers = 4;
    cells.push_back(cell);
  }
}

void pairs(std::vector<Cell>& cells) {
  const std::pair<Knob, Knob> all[] = {
      {contrast(), poisson()}, {contrast(), crack()}, {poisson(), sliver()}, {alpha(), crack()}};
  for (const auto& [a, b] : all) {
    for (double x : a.values) {
      for (double y : b.values) {
        Cell cell{a.name + " x " + b.name, {}};
        a.set(cell.difficulty, x);
        b.set(cell.difficulty, y);
        cells.push_back(cell);
      }
    }
  }
}

std::string quoted(std::string text) {
  for (std::size_t i = 0; (i = text.find('"', i)) != std::string::npos; i += 2)
    text.insert(i, 1, '"');
  return '"' + text + '"';
}

void write_row(std::ostream& out, const Cell& cell, const Method& method, std::size_t removed,
               const Reference& reference, const Outcome& o) {
  const Difficulty& d = cell.difficulty;
  out << cell.study << ',' << d.contrast << ',' << d.poisson << ',' << d.sliver << ',' << d.alpha
      << ',' << d.unit << ',' << (d.pooled ? "pooled" : "element") << ',' << d.pattern << ','
      << removed << ',' << cell.batch << ',' << method.name << ',' << o.verdict << ',' << o.u_error
      << ',' << o.stress_error << ',' << o.residual << ',' << o.estimate << ',' << o.iterations
      << ',' << o.first_ms << ',' << o.median_ms << ',' << reference.rounding << ','
      << quoted(o.reason) << '\n';
}

/// Returns the number of cells that are WRONG.
int run(std::ostream& out, const std::vector<Cell>& cells) {
  const auto all = methods();
  out << "study,contrast,nu,sliver,alpha,unit,volume,pattern,fractures,batch,method,verdict,u_"
         "error,"
         "stress_error,residual,estimate,iterations,first_ms,median_ms,fp32_rounding,reason\n";
  int wrong = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const DifficultBoard board = difficult_board(cells[i].difficulty);
    const Reference reference(*board.problem, board.removed, board.force);
    for (const Method& m : all) {
      const Outcome outcome =
          run_cell(m, *board.problem, board.force, board.removed, cells[i].batch, reference);
      wrong += outcome.verdict == "WRONG";
      write_row(out, cells[i], m, board.removed.size(), reference, outcome);
    }
    std::fprintf(stderr, "\rcell %zu of %zu, wrong %d ", i + 1, cells.size(), wrong);
  }
  std::fputc('\n', stderr);
  return wrong;
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  using namespace sunder::bench;
  const std::string mode = argc > 2 ? argv[2] : "full";
  if (argc < 2 || argc > 3 ||
      (mode != "quick" && mode != "full" && mode != "many" && mode != "pooled")) {
    std::cerr << "usage: bench_stability FILE [quick|full|many|pooled]\n";
    return 2;
  }
  std::vector<Cell> cells;
  if (mode == "quick" || mode == "full") one_at_a_time(cells);
  if (mode != "many") pooled(cells, mode != "quick");
  if (mode == "many") many_fractures(cells);
  if (mode == "full") pairs(cells);
  std::ofstream out(argv[1]);
  const int wrong = run(out, cells);
  out.close();
  if (!out) {
    std::cerr << "cannot write " << argv[1] << '\n';
    return 3;
  }
  return wrong > 0;
}
