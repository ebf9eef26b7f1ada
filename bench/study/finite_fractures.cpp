// SPDX-License-Identifier: Apache-2.0
// Finite statics along fractures of the paper's board, pulled until its largest rotation is 10, 30
// and 60 degrees, or with 300 N where that is less. Two questions to Newton's method with a factor
// of the exact tangent each iteration (tests/support/finite_newton.hpp), started where the solver
// ended:
//   state     with 0 to 200 elements of a crack gone, one by one or in batches, converged to 1e-10:
//             right where displacement and stress agree within the accuracy table's 1e-8
//   sequence  at the default tolerance the element with the largest maximum shear stress breaks,
//             again and again: right where Newton's stress says the same one, or where the two are
//             nearer to each other than twice the tolerance
//   bench_finite_fractures FILE [quick|full]
// A step that does not come to rest is refused, one from which Newton's method does not end is
// without a reference. Exit code 1 where one is WRONG.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <string>

#include "body/hyperelastic_pass.hpp"
#include "material/corotated.hpp"
#include "material/neo_hookean.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"
#include "support/finite_torn.hpp"
#include "support/sequences.hpp"

namespace sunder::bench {
namespace {

constexpr double kNewtonsMore = 3, kMostNewtons = 300;
constexpr double kConverged = 1e-10, kDefault = 1e-4, kBand = 2;
constexpr double kNewtonResidual = 1e-9;  // over it the reference is none
constexpr int kMostCalls = 200;

/// The board, as it is torn.
class Board {
 public:
  Board(const Law& law, double tolerance)
      : torn_(law, {.tolerance = tolerance, .most_factors = 40}) {}

  /// False: no rest.
  bool pull(double newtons) {
    back_solves_ = factors_ = 0;
    newtons_ = newtons;
    for (int i = 0; i < kMostCalls; ++i) {
      const auto report = torn_.pull(newtons);
      back_solves_ += report.back_solves;
      factors_ += report.factors;
      if (!report.unfinished) return report.at_rest;
    }
    return false;
  }
  void tear(std::span<const Index> elements) { torn_.tear(elements); }
  [[nodiscard]] double rotation_deg() {
    fem::HyperelasticPass pass(torn_.body);
    return pass.run(u(), {.deformation = true}).deformation.rotation_deg;
  }
  [[nodiscard]] std::vector<Voigt> stress(std::span<const double> of) const {
    return torn_.stress(of);
  }
  /// From here; empty: Newton's method does not end.
  [[nodiscard]] std::vector<double> newton() const {
    try {
      auto rest = test::newton({problem(), torn_.laws, out()}, torn_.load(newtons_), u());
      if (rest.residual <= kNewtonResidual) return std::move(rest.u);
    } catch (const NumericalError&) {
    }
    return {};
  }
  /// The breakable element of the largest maximum shear stress.
  [[nodiscard]] Index weakest(std::span<const Voigt> stress) const {
    Index worst = kNone;
    for (Index e = 0; e < problem().tet_count(); ++e) {
      if (out()[e] || !problem().breakable(e)) continue;
      if (worst == kNone || max_shear(stress[e]) > max_shear(stress[worst])) worst = e;
    }
    return worst;
  }
  [[nodiscard]] const std::vector<double>& u() const { return torn_.statics.displacement(); }
  [[nodiscard]] std::span<const std::uint8_t> out() const { return torn_.statics.out(); }
  [[nodiscard]] const Problem& problem() const { return torn_.problem; }
  [[nodiscard]] int back_solves() const { return back_solves_; }
  [[nodiscard]] int factors() const { return factors_; }

 private:
  test::FiniteTorn torn_;
  double newtons_ = 0;
  int back_solves_ = 0, factors_ = 0;
};

struct Row {
  std::string part, law, how;
  double degrees, newtons;
  std::size_t gone = 0;
  double u_error = NAN, stress_error = NAN;
};

class Study {
 public:
  explicit Study(std::ostream& out) : out_(out) {
    out_ << "part,law,how,degrees,newtons,gone,verdict,u_error,stress_error,back_solves,factors\n";
  }

  void states(const Law& law, double degrees, bool one_by_one, std::size_t most) {
    Board board(law, kConverged);
    Row row{"state", std::string(law.name), one_by_one ? "one by one" : "batches", degrees, 0};
    if (!reach(board, row)) return;
    judge(board, row);
    const auto sequence = test::crack_sequence(board.problem(), most, 15);
    for (const std::size_t count : {1u, 10u, 50u, 100u, 200u}) {
      if (count > most) break;
      bool at_rest = true;
      while (at_rest && row.gone < count) {
        const std::size_t next = one_by_one ? row.gone + 1 : count;
        board.tear(std::span(sequence).subspan(row.gone, next - row.gone));
        row.gone = next;
        at_rest = board.pull(row.newtons);
      }
      if (!at_rest) {
        add(board, row, "refused");
        return;
      }
      judge(board, row);
    }
  }

  void sequence(const Law& law, double degrees, std::size_t most) {
    Board board(law, kDefault);
    Row row{"sequence", std::string(law.name), "weakest", degrees, 0};
    if (!reach(board, row)) return;
    while (row.gone < most) {
      const Index mine = board.weakest(board.stress(board.u()));
      const std::vector<double> u = board.newton();
      if (u.empty()) {
        add(board, row, "no reference");
      } else {
        const auto exact = board.stress(u);
        const double worst = max_shear(exact[board.weakest(exact)]);
        row.stress_error = (worst - max_shear(exact[mine])) / worst;
        add(board, row, row.stress_error <= kBand * kDefault ? "right" : "WRONG");
      }
      board.tear({&mine, 1});
      ++row.gone;
      if (!board.pull(row.newtons)) {
        add(board, row, "refused");
        return;
      }
    }
  }

  /// Returns the number of rows that are WRONG.
  int finish() {
    for (const auto& [verdict, count] : verdicts_) std::printf("%s %d\n", verdict.c_str(), count);
    std::printf("largest error where right: displacement %.1e, stress %.1e\n", most_u_,
                most_stress_);
    return verdicts_["WRONG"];
  }

 private:
  bool reach(Board& board, Row& row) {
    while (board.rotation_deg() < row.degrees && row.newtons < kMostNewtons) {
      row.newtons += kNewtonsMore;
      if (!board.pull(row.newtons)) {
        add(board, row, "refused");
        return false;
      }
    }
    row.degrees = board.rotation_deg();
    return true;
  }
  void judge(const Board& board, Row& row) {
    const std::vector<double> u = board.newton();
    if (u.empty()) {
      add(board, row, "no reference");
      return;
    }
    row.u_error = test::displacement_error(board.problem().mesh(), board.out(), board.u(), u);
    row.stress_error = test::stress_error(board.out(), board.stress(board.u()), board.stress(u));
    const bool right =
        row.u_error <= test::kCrackTolerance && row.stress_error <= test::kCrackTolerance;
    if (right) {
      most_u_ = std::max(most_u_, row.u_error);
      most_stress_ = std::max(most_stress_, row.stress_error);
    }
    add(board, row, right ? "right" : "WRONG");
  }
  void add(const Board& board, Row& row, const std::string& verdict) {
    ++verdicts_[verdict];
    out_ << row.part << ',' << row.law << ',' << row.how << ',' << row.degrees << ',' << row.newtons
         << ',' << row.gone << ',' << verdict << ',' << row.u_error << ',' << row.stress_error
         << ',' << board.back_solves() << ',' << board.factors() << '\n';
    out_.flush();
    row.u_error = row.stress_error = NAN;
    std::fprintf(stderr, "\r%s, %s, %.0f degrees, %zu gone      ", row.law.c_str(),
                 row.part.c_str(), row.degrees, row.gone);
  }

  std::ostream& out_;
  std::map<std::string, int> verdicts_;
  double most_u_ = 0, most_stress_ = 0;
};

int run(std::ostream& out, bool full) {
  Study study(out);
  for (const Law* law : {&kCorotated, &kNeoHookean}) {
    for (const double degrees : {10.0, 30.0, 60.0}) {
      if (!full && degrees > 10) break;
      for (const bool one_by_one : {true, false}) {
        study.states(*law, degrees, one_by_one, full ? 200 : 10);
      }
      study.sequence(*law, degrees, full ? 50 : 5);
    }
  }
  std::fputc('\n', stderr);
  return study.finish();
}

}  // namespace
}  // namespace sunder::bench

int main(int argc, char** argv) {
  const std::string mode = argc > 2 ? argv[2] : "full";
  if (argc < 2 || argc > 3 || (mode != "quick" && mode != "full")) {
    std::cerr << "usage: bench_finite_fractures FILE [quick|full]\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  const int wrong = sunder::bench::run(out, mode == "full");
  out.close();
  if (!out) {
    std::cerr << "cannot write " << argv[1] << '\n';
    return 3;
  }
  return wrong > 0;
}
