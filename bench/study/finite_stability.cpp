// SPDX-License-Identifier: Apache-2.0
// The stability study at finite deformation: one body, two hands, both laws that keep their stress
// in compression, far motions, then stretch, twist and tear with every contrast, Poisson's ratio
// and sliver; then pooled volume, fibres and an interface, by each way that computes them, and all
// three together; interfaces on other boards than the plain one by one way each, in turns. Each
// step is judged by a yardstick, which starts where the step ended and must stay there
// (finite_body.cpp).
//   bench_finite_stability FILE [quick|full [STUDY]]
// STUDY: motion, grid, pooled, fibres, interface or together; left out: all of them.
// A step is right, over (off by more than the tolerance, but not by more than twice that),
// unfinished (its path to rest goes on), refused with the reason and the state before it usable,
// "no yardstick" where none finds a rest from there, or WRONG: a number that is off by more than
// that, no number, or a lost state. A way that does not compute such a body is one row, refused.
// Exit code 1 where one is WRONG.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "bench/has_vulkan.hpp"
#include "bench/study/finite_body.hpp"
#include "sunder/error.hpp"

namespace sunder::bench {
namespace {

struct Way {
  std::string name;
  SolverOptions options;
};

Way way(const char* backend, Route route, const char* name) {
  Way made{name, {}};
  made.options.backend = backend;
  made.options.route = route;
  return made;
}

/// Of all cells, and of those with something added.
const Way kUsual = way("cpu", Route::automatic, "cpu");
std::vector<Way> ways(bool full) {
  std::vector<Way> all{way("cpu", Route::factor, "cpu factor"),
                       way("cpu", Route::inverse, "cpu inverse")};
  if (has_vulkan()) {
    if (full) all.push_back(way("vulkan", Route::factor, "vulkan factor"));
    all.push_back(way("vulkan", Route::inverse, "vulkan inverse"));
  }
  return all;
}

const std::pair<MaterialLaw, const char*> kLaws[] = {
    {MaterialLaw::linear, "linear"},
    {MaterialLaw::corotated, "corotated"},
    {MaterialLaw::neo_hookean, "neo-hookean"},
    {MaterialLaw::saint_venant_kirchhoff, "saint-venant-kirchhoff"}};
std::string name_of(MaterialLaw law) {
  return std::ranges::find(kLaws, law, &std::pair<MaterialLaw, const char*>::first)->second;
}

constexpr auto kLinear = MaterialLaw::linear, kCorotated = MaterialLaw::corotated,
               kNeoHookean = MaterialLaw::neo_hookean;
const char* const kQuick[] = {"stretch", "turn", "twist", "tear"};
const char* const kFar[] = {"fold", "jump", "through"};
const char* const kGrid[] = {"stretch", "twist", "tear"};

void by_element(std::vector<FiniteCell>& cells, bool full) {
  for (const auto law : {kCorotated, kNeoHookean}) {
    for (const char* motion : kQuick) cells.push_back({"motion", law, 1, .45, 1, motion});
    if (!full) continue;
    for (const char* motion : kFar) cells.push_back({"motion", law, 1, .45, 1, motion});
    for (const double contrast : {1.0, 1e3, 1e6}) {
      for (const double nu : {.3, .45, .49, .499}) {
        for (const double sliver : {1.0, 1e-1, 1e-2, 1e-3}) {
          for (const char* motion : kGrid)
            cells.push_back({"grid", law, contrast, nu, sliver, motion});
        }
      }
    }
  }
}

/// Law linear pools in bench_stability: here it would be no body of finite deformation.
void pooled(std::vector<FiniteCell>& cells, bool full) {
  for (const double nu : {.45, .49, .499, .4999}) {
    if (!full && nu == .45) continue;
    for (const double contrast : {1.0, 1e2, 1e4}) {
      for (const double sliver : {1.0, 1e-1, 1e-2}) {
        if (!full && (contrast != 1e2 || sliver != 1)) continue;
        for (const char* motion : kGrid)
          cells.push_back({"pooled", kNeoHookean, contrast, nu, sliver, motion, true});
      }
    }
    if (!full) continue;
    for (const char* motion : kFar)
      cells.push_back({"pooled", kNeoHookean, 1, nu, 1, motion, true});
  }
}

void fibres(std::vector<FiniteCell>& cells, bool full) {
  const auto add = [&](MaterialLaw law, const FibreDifficulty& of, double nu = .45,
                       double contrast = 1, double sliver = 1) {
    for (const char* motion : kGrid) {
      if (!full && motion == kGrid[0]) continue;  // tears begin with a stretch
      cells.push_back({"fibres", law, contrast, nu, sliver, motion, false, of});
    }
  };
  for (const double k1 : {.5, 50.0, 5e3}) {
    add(kLinear, {1, 10 * k1});
    for (const auto law : {kCorotated, kNeoHookean}) {
      for (const int families : {1, 2}) {
        for (const double dispersion : {0.0, 1.0 / 3}) {
          for (const double k2 : {0.0, 10.0, 1e3}) {
            // One at a time: stiff, quickly stiffening, two families, dispersed.
            const int unlike = (k1 != 50) + (families != 1) + (dispersion > 0) + (k2 != 10);
            if (full || (unlike <= 1 && law == kNeoHookean))
              add(law, {families, k1, k2, dispersion});
          }
        }
      }
    }
  }
  if (!full) return;
  for (const auto law : {kCorotated, kNeoHookean}) {
    for (const double nu : {.3, .499}) add(law, {2, 50, 10, .1}, nu);
    for (const double contrast : {1e3, 1e6}) add(law, {2, 50, 10, .1}, .45, contrast);
    for (const double sliver : {1e-1, 1e-2}) add(law, {2, 50, 10, .1}, .45, 1, sliver);
  }
}

/// From one that opens as far as the board is long to one as stiff as any is taken, and one beyond.
void interfaces(std::vector<FiniteCell>& cells, bool full) {
  const InterfaceDifficulty all[] = {{.01, 1},    {1, 1},      {1, 1e-3},
                                     {100, 1e-1}, {100, 1e-3}, {100, 1e-4}};
  for (const InterfaceDifficulty& of : all) {
    for (const auto law : {kLinear, kCorotated, kNeoHookean}) {
      if (!full && law != kNeoHookean) continue;
      const auto add = [&](const char* motion, double nu, double contrast, double sliver) {
        cells.push_back({"interface", law, contrast, nu, sliver, motion, false, {}, of});
      };
      for (const char* motion : {"stretch", "twist", "part"}) {
        // The softest one finds no rest in a twist, and says so after minutes of looking.
        if (of.strength < 1 && std::string(motion) == "twist") continue;
        if (full || std::string(motion) != "stretch") add(motion, .45, 1, 1);
        if (!full) continue;
        for (const double nu : {.3, .499}) add(motion, nu, 1, 1);
        for (const double contrast : {1e3, 1e6}) add(motion, .45, contrast, 1);
        for (const double sliver : {1e-1, 1e-2}) add(motion, .45, 1, sliver);
      }
    }
  }
}

/// Pooled volume, two families of fibres and an interface in one body.
void together(std::vector<FiniteCell>& cells, bool full) {
  for (const double nu : {.49, .499, .4999}) {
    if (!full && nu != .499) continue;
    for (const double contrast : {1.0, 1e2}) {
      if (!full && contrast != 1e2) continue;
      for (const char* motion : {"stretch", "twist", "tear", "part"}) {
        cells.push_back({"together", kNeoHookean, contrast, nu, 1, motion, true,
                         FibreDifficulty{2, 50, 10, .1}, InterfaceDifficulty{1, 1e-2}});
      }
    }
  }
}

/// `only`: of that study; empty: all.
std::vector<FiniteCell> cells_of(bool full, const std::string& only) {
  std::vector<FiniteCell> cells;
  by_element(cells, full);
  pooled(cells, full);
  fibres(cells, full);
  interfaces(cells, full);
  together(cells, full);
  if (!only.empty()) std::erase_if(cells, [&](const auto& cell) { return cell.study != only; });
  return cells;
}

/// What is added to the board, in words.
std::string added(const FiniteCell& cell) {
  std::ostringstream text;
  if (cell.pooled) text << "pooled ";
  if (cell.fibres) {
    const FibreDifficulty& of = *cell.fibres;
    text << of.families << (of.families > 1 ? " families" : " family") << " k1 " << of.k1 << " k2 "
         << of.k2 << " kappa " << of.dispersion << ' ';
  }
  if (cell.interface)
    text << "strength " << cell.interface->strength << " energy " << cell.interface->energy << ' ';
  std::string words = text.str();
  if (!words.empty()) words.pop_back();
  return words;
}

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + text + '"';
}

/// What steps came to, and how the estimate of the stress error stands to the true one.
class Summary {
 public:
  void add(const StepOutcome& o) {
    ++verdicts_[o.verdict];
    if (o.stress_error > kLeastError) ratios_.push_back(o.estimate / o.stress_error);
  }
  void print() {
    for (const auto& [verdict, count] : verdicts_) std::printf("%s %d\n", verdict.c_str(), count);
    if (ratios_.empty()) return;
    std::ranges::sort(ratios_);
    const auto under = std::ranges::lower_bound(ratios_, 1 / kBand) - ratios_.begin();
    std::printf(
        "reported over true error of stress in %zu steps: least %.2f, median %.2f, most "
        "%.0f; under half in %td\n",
        ratios_.size(), ratios_.front(), ratios_[ratios_.size() / 2], ratios_.back(), under);
  }
  [[nodiscard]] int wrong() { return verdicts_["WRONG"]; }

 private:
  static constexpr double kLeastError = 1e-7;  // a thousandth of the tolerance
  std::map<std::string, int> verdicts_;
  std::vector<double> ratios_;
};

void write_row(std::ostream& out, const FiniteCell& cell, const Way& by, double amount,
               const StepOutcome& o) {
  out << cell.study << ',' << name_of(cell.law) << ',' << cell.contrast << ',' << cell.poisson
      << ',' << cell.sliver << ',' << added(cell) << ',' << by.name << ',' << cell.motion << ','
      << amount << ',' << o.verdict << ',' << o.u_error << ',' << o.stress_error << ','
      << o.estimate << ',' << o.back_solves << ',' << o.calls << ',' << o.deformation.strain << ','
      << o.deformation.rotation_deg << ',' << o.deformation.inverted << ',' << quoted(o.reason)
      << '\n';
  out.flush();
}

void run_cell(std::ostream& out, const FiniteCell& cell, const Way& by, Summary& summary) {
  try {
    FiniteBodyOfStudy body(cell, by.options);
    for (const Step& step : steps_of(cell.motion, body.problem())) {
      const StepOutcome o = body.take(step);
      summary.add(o);
      write_row(out, cell, by, step.amount, o);
      if (o.verdict == "unfinished") return;  // the next step would go on from no equilibrium
    }
  } catch (const Error& error) {  // such a body is not computed so
    StepOutcome refused;
    refused.verdict = "refused";
    refused.reason = error.what();
    summary.add(refused);
    write_row(out, cell, by, 0, refused);
  }
}

/// Interfaces look for their rests for minutes: only those of the plain board do so by every way.
bool takes_turns(const FiniteCell& cell) {
  const bool plain = cell.contrast == 1 && cell.poisson == .45 && cell.sliver == 1;
  return cell.study == "interface" && !plain;
}

/// Returns the number of steps that are WRONG.
int run(std::ostream& out, const std::vector<FiniteCell>& cells, bool full) {
  out << "study,law,contrast,nu,sliver,added,method,motion,amount,verdict,u_error,stress_error,"
         "estimate,back_solves,calls,strain,rotation_deg,inverted,reason\n";
  Summary summary;
  const auto every = ways(full);
  std::size_t turn = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (added(cells[i]).empty()) {
      run_cell(out, cells[i], kUsual, summary);
    } else if (takes_turns(cells[i])) {
      run_cell(out, cells[i], every[turn++ % every.size()], summary);
    } else {
      for (const Way& by : every) run_cell(out, cells[i], by, summary);
    }
    std::fprintf(stderr, "\rcell %zu of %zu, wrong %d ", i + 1, cells.size(), summary.wrong());
  }
  std::fputc('\n', stderr);
  summary.print();
  return summary.wrong();
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  using namespace sunder::bench;
  const std::string mode = argc > 2 ? argv[2] : "full";
  if (argc < 2 || argc > 4 || (mode != "quick" && mode != "full")) {
    std::cerr << "usage: bench_finite_stability FILE [quick|full [STUDY]]\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  const int wrong = run(out, cells_of(mode == "full", argc > 3 ? argv[3] : ""), mode == "full");
  out.close();
  if (!out) {
    std::cerr << "cannot write " << argv[1] << '\n';
    return 3;
  }
  return wrong > 0;
}
