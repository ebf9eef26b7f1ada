// SPDX-License-Identifier: Apache-2.0
// The stability study at finite deformation: one body, two hands, both laws that keep their stress
// in compression, far motions, then stretch, twist and tear with every contrast, Poisson's ratio
// and sliver; each step judged by the yardstick's Newton (cpu_reference/plain), which starts where
// the step ended and must stay there.
//   bench_finite_stability FILE [quick|full [LAW]]
// A step is right, over (off by more than the tolerance, but not by more than twice that),
// unfinished (its path to rest goes on), refused with the reason and the state before it usable,
// "no yardstick" where that finds no rest from there, or WRONG: a number that is off by more than
// that, no number, or a lost state. Exit code 1 where one is.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <numbers>
#include <stdexcept>

#include "cpu_reference/cpu_reference.hpp"
#include "cpu_reference/plain/finite.hpp"
#include "fracture/criterion.hpp"
#include "frame/loads.hpp"
#include "sunder/error.hpp"
#include "support/accuracy.hpp"
#include "support/finite_newton.hpp"
#include "support/sequences.hpp"
#include "support/sliver.hpp"
#include "support/structured_board.hpp"

namespace sunder::bench {
namespace {

constexpr double kSide = 50, kDepth = 5;
constexpr int kMostCalls = 400;  // of a step whose path goes on
constexpr double kMostContrast = 1e4, kNewtonResidual = 1e-7;
// What is reported may be half of the error in one frame of a hundred (docs/method.md).
constexpr double kBand = 2;
constexpr double kSameState = 1e-2;  // of the tolerance's own scale: a state found again

struct Cell {
  std::string study;
  MaterialLaw law = MaterialLaw::corotated;
  double contrast = 1, poisson = 0.45, sliver = 1;
  std::string motion;
};

/// Where the lower hand is, and the upper one where it moves too.
struct Hands {
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
  Vec3 lower_turn = Vec3::Zero(), upper_turn = Vec3::Zero();  // [deg]
};
struct Step {
  double amount;  ///< as the motion counts it
  Hands hands;
  std::vector<Index> destroyed;  ///< before it
  bool rigid = false;            ///< the body as a whole: it has no stress
};

Scene scene_of(const Cell& cell) {
  Scene scene;
  scene.title = "board of the stability study at finite deformation";
  scene.mesh = test::structured_board({6, 6, 1, kSide, kSide, kDepth}, [](const Vec3& x) {
    return x.y() > 41 || x.y() < 9 ? "frame" : x.y() > 25 ? "upper" : "lower";
  });
  if (cell.sliver < 1) test::make_sliver(scene.mesh, Vec3(25, 33, 2.5), 9, cell.sliver);
  scene.materials = {{"upper", {5, cell.poisson, 2.0, cell.law}},
                     {"lower", {8, cell.poisson, 4.0, cell.law}},
                     {"frame", {5 * cell.contrast, cell.poisson, std::nullopt, cell.law}}};
  for (const double y : {0.0, kSide}) {
    Instrument hand;
    hand.name = y == 0 ? "lower" : "upper";
    hand.action = Grip{Box{Vec3(-1, y - .01, -1), Vec3(51, y + .01, 6)}, Vec3(0, 0, 0), Axes{7},
                       true, Vec3(0, 0, 0)};
    scene.instruments.push_back(hand);
  }
  return scene;
}

/// Both hands turned about the board's middle as one.
Hands turned_as_one(double degrees) {
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  const Mat3 r = Eigen::AngleAxisd(degrees / 180 * std::numbers::pi, axis).toRotationMatrix();
  const Vec3 arm(0, kSide / 2, 0);
  Hands hands;
  hands.lower_turn = hands.upper_turn = degrees * axis;
  hands.upper = r * arm - arm;
  hands.lower = -hands.upper;
  return hands;
}

std::vector<Step> steps_of(const std::string& motion, const Problem& problem) {
  std::vector<Step> steps;
  const auto lower_to = [&](double amount, const Vec3& at, const Vec3& turn = Vec3::Zero()) {
    Hands hands;
    hands.lower = at;
    hands.lower_turn = turn;
    steps.push_back({amount, hands, {}});
  };
  const auto stretch = [&](double strain) { lower_to(strain, Vec3(0, -strain * kSide, 0)); };
  if (motion == "stretch") {
    for (double strain : {.1, .2, .4, .6, .8, 1.0}) stretch(strain);
  } else if (motion == "turn") {
    for (double degrees = 30; degrees <= 180; degrees += 30)
      steps.push_back({degrees, turned_as_one(degrees), {}, true});
  } else if (motion == "twist") {
    for (double degrees = 30; degrees <= 180; degrees += 30)
      lower_to(degrees, Vec3(0, 0, 0), Vec3(0, degrees, 0));
  } else if (motion == "fold") {
    // About the board's own width: the lower edge comes over to the other side.
    for (double degrees = 30; degrees <= 180; degrees += 30) {
      const double a = degrees / 180 * std::numbers::pi;
      const double radius = kSide / 2;
      lower_to(degrees, Vec3(0, radius * (1 - std::cos(a)), radius * std::sin(a)),
               Vec3(degrees, 0, 0));
    }
  } else if (motion == "jump") {
    stretch(.1);
    stretch(10);
    stretch(.1);
  } else if (motion == "through") {
    // In one step through the upper hand: what follows linearly is inside out.
    stretch(-2.0);
    stretch(-1.0);
    stretch(0);
    steps.back().rigid = true;
    stretch(.1);
  } else if (motion == "tear") {
    stretch(.1);
    stretch(.2);
    const auto crack = test::elements_across(problem.mesh(), 27);
    for (std::size_t i = 0; i < 3; ++i) {
      stretch(.2);
      steps.back().destroyed.assign(crack.begin() + 4 * static_cast<long>(i),
                                    crack.begin() + 4 * static_cast<long>(i + 1));
    }
    stretch(.3);
  } else {
    throw std::invalid_argument("unknown motion " + motion);
  }
  return steps;
}

struct Outcome {
  std::string verdict, reason;
  double u_error = NAN, stress_error = NAN, estimate = NAN;
  int back_solves = 0, calls = 0;
  Deformation deformation;
};

class Body {
 public:
  explicit Body(const Cell& cell)
      : contrast_(cell.contrast),
        problem_(std::make_shared<Problem>(scene_of(cell))),
        criterion_(make_criterion(*problem_)),
        loads_(*problem_),
        backend_(cpu_reference::create(problem_, needs())) {
    at_ = load_of({});
  }
  [[nodiscard]] const Problem& problem() const { return *problem_; }

  Outcome take(const Step& step) {
    Outcome outcome;
    if (!step.destroyed.empty()) backend_->destroy(step.destroyed);
    const Load load = load_of(step.hands);
    const std::vector<double> before = displacement();
    try {
      SolveReport report = solve(load, outcome);
      outcome.estimate = report.error;
      if (report.unfinished) {
        outcome.verdict = "unfinished";
        return outcome;
      }
      at_ = load;
      judge(load, step.rigid, outcome);
    } catch (const NumericalError& error) {
      outcome.verdict = "refused";
      outcome.reason = error.what();
      if (displacement() != before) {
        outcome.reason += "; what can be read then is no state at rest";
      }
      if (!usable(before, step.destroyed.empty())) {
        outcome.verdict = "WRONG";
        outcome.reason = "the state before is lost after: " + outcome.reason;
      }
    }
    return outcome;
  }

 private:
  static Needs needs() {
    Needs needs;
    needs.stress = needs.damage = true;
    return needs;
  }
  Load load_of(const Hands& hands) {
    loads_.drive(0, hands.lower);
    loads_.turn(0, hands.lower_turn);
    loads_.drive(1, hands.upper);
    loads_.turn(1, hands.upper_turn);
    std::vector<Finding> findings;
    loads_.update(0, *criterion_, backend_->destroyed(), findings);
    return loads_.load();
  }
  std::vector<double> displacement() const {
    std::vector<double> u(problem_->dofs().size());
    if (solved_) backend_->read_displacement(u);
    return u;
  }
  SolveReport solve(const Load& load, Outcome& outcome) {
    backend_->set_load(load);
    SolveReport report;
    do {
      report = backend_->solve();
      solved_ = true;
      outcome.back_solves += report.back_solves;
    } while (report.unfinished && ++outcome.calls < kMostCalls);
    return report;
  }
  /// The load before can be solved again, and where nothing has left that leads back.
  bool usable(const std::vector<double>& before, bool same_body) {
    Outcome again;
    try {
      if (solve(at_, again).unfinished) return true;
    } catch (const NumericalError&) {
      return !same_body;
    }
    double apart = 0, most = 0;
    const std::vector<double> u = displacement();
    for (std::size_t i = 0; i < u.size(); ++i) {
      if (!std::isfinite(u[i])) return false;
      apart = std::max(apart, std::abs(u[i] - before[i]));
      most = std::max(most, std::abs(before[i]));
    }
    return !same_body || apart <= kSameState * std::max(most, 1e-3 * kSide);
  }
  void judge(const Load& load, bool rigid, Outcome& outcome) {
    backend_->stress();
    const std::vector<double> u = displacement();
    std::vector<Voigt> stress(problem_->mesh().tets.size());
    backend_->read_stress(stress);
    outcome.deformation = backend_->deformation();
    const std::vector<std::uint8_t> destroyed(backend_->destroyed().begin(),
                                              backend_->destroyed().end());
    if (!std::all_of(u.begin(), u.end(), [](double x) { return std::isfinite(x); })) {
      outcome.verdict = "WRONG";
      outcome.reason = "not a number";
      return;
    }
    if (rigid) {  // what the yardstick's residual is measured by is rounding then
      const std::vector<Voigt> none(stress.size(), Voigt::Zero());
      outcome.stress_error = stress_error(destroyed, stress, none);
    } else if (!compare(load, destroyed, u, stress, outcome)) {
      return;
    }
    const double share = outcome.stress_error / problem_->scene().solver.tolerance;
    outcome.verdict = share <= 1 ? "right" : share <= kBand ? "over" : "WRONG";
  }
  /// With the yardstick; false: neither it nor Newton's method with the library's own tangent
  /// comes to rest. The yardstick's displacement is rounded to double precision between its
  /// iterations, which in a stiff frame is more force than it lets stay.
  bool compare(const Load& load, std::span<const std::uint8_t> destroyed,
               const std::vector<double>& u, std::span<const Voigt> stress, Outcome& outcome) {
    const plain::FiniteBody yardstick(*problem_, destroyed);
    std::vector<double> rest;
    try {
      if (contrast_ > kMostContrast) throw std::runtime_error("too stiff a frame");
      rest = yardstick.solve(load, u).displacement;
    } catch (const std::runtime_error& error) {
      outcome.reason = std::string("yardstick: ") + error.what();
      rest = by_newton(load, destroyed, u);
      if (rest.empty()) {
        outcome.verdict = "no yardstick";
        return false;
      }
      outcome.reason += "; Newton with the library's tangent instead";
    }
    const auto exact = yardstick.stress(rest, StressMeasure::cauchy);
    outcome.u_error = test::displacement_error(problem_->mesh(), destroyed, u, rest);
    outcome.stress_error = stress_error(destroyed, stress, exact);
    return true;
  }
  /// Empty: its tangent is indefinite, or its residual stays.
  std::vector<double> by_newton(const Load& load, std::span<const std::uint8_t> destroyed,
                                const std::vector<double>& u) const {
    const auto laws = fem::laws_of(*problem_);
    try {
      const auto rest = test::newton({*problem_, laws, destroyed}, load, u);
      if (rest.residual <= kNewtonResidual) return rest.u;
    } catch (const NumericalError&) {
    }
    return {};
  }
  /// Where there is none, as after a rigid motion, a millionth of the material's modulus is as
  /// good.
  static double stress_error(std::span<const std::uint8_t> destroyed, std::span<const Voigt> found,
                             std::span<const Voigt> exact) {
    double apart = 0, most = 1e-6 * 5;
    for (std::size_t e = 0; e < found.size(); ++e) {
      if (destroyed[e]) continue;
      const double d = test::tensor_norm(found[e] - exact[e]);
      if (!std::isfinite(d)) return d;
      apart = std::max(apart, d);
      most = std::max(most, test::tensor_norm(exact[e]));
    }
    return apart / most;
  }

  double contrast_;
  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<FractureCriterion> criterion_;
  Loads loads_;
  std::unique_ptr<Backend> backend_;
  Load at_;              // of the last step at rest
  bool solved_ = false;  // once
};

const char* const kQuick[] = {"stretch", "turn", "twist", "tear"};
const char* const kFar[] = {"fold", "jump", "through"};
const char* const kGrid[] = {"stretch", "twist", "tear"};

/// `only`: of that law; empty: of both.
std::vector<Cell> cells_of(bool full, const std::string& only) {
  std::vector<Cell> cells;
  for (const auto& [law, name] : {std::pair(MaterialLaw::corotated, "corotated"),
                                  std::pair(MaterialLaw::neo_hookean, "neo-hookean")}) {
    if (!only.empty() && only != name) continue;
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
  return cells;
}

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + text + '"';
}

/// What steps came to, and how the estimate of the stress error stands to the true one.
class Summary {
 public:
  void add(const Outcome& o) {
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

/// Returns the number of steps that are WRONG.
int run(std::ostream& out, const std::vector<Cell>& cells) {
  out << "study,law,contrast,nu,sliver,motion,amount,verdict,u_error,stress_error,estimate,"
         "back_solves,calls,strain,rotation_deg,inverted,reason\n";
  Summary summary;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& cell = cells[i];
    Body body(cell);
    for (const Step& step : steps_of(cell.motion, body.problem())) {
      const Outcome o = body.take(step);
      summary.add(o);
      out << cell.study << ',' << body.problem().law() << ',' << cell.contrast << ','
          << cell.poisson << ',' << cell.sliver << ',' << cell.motion << ',' << step.amount << ','
          << o.verdict << ',' << o.u_error << ',' << o.stress_error << ',' << o.estimate << ','
          << o.back_solves << ',' << o.calls << ',' << o.deformation.strain << ','
          << o.deformation.rotation_deg << ',' << o.deformation.inverted << ',' << quoted(o.reason)
          << '\n';
      out.flush();
      if (o.verdict == "unfinished") break;  // the next step would go on from no equilibrium
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
    std::cerr << "usage: bench_finite_stability FILE [quick|full [LAW]]\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  const int wrong = run(out, cells_of(mode == "full", argc > 3 ? argv[3] : ""));
  out.close();
  if (!out) {
    std::cerr << "cannot write " << argv[1] << '\n';
    return 3;
  }
  return wrong > 0;
}
