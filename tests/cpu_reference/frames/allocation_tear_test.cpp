// SPDX-License-Identifier: Apache-2.0
// Hundreds of fractures one after the other allocate nothing: new bases begin and are taken, the
// load turns, and fields outside a condensed region are read.
#include <gtest/gtest.h>

#include <cmath>

#include "cpu_reference/frames/allocation_count.hpp"
#include "cpu_reference/frames/allocation_ways.hpp"
#include "sunder/simulation.hpp"
#include "support/body.hpp"
#include "support/notch_board.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

/// Counts the bases that a deferred update has had: a new one has less damage over it.
class Bases {
 public:
  void look_at(const Backend& backend) {
    std::size_t damage = 0;
    for (const BufferPlan& b : backend.buffers()) {
      if (b.name == "small matrix of the damage") damage = b.bytes;
    }
    count_ += damage < damage_;
    damage_ = damage;
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  int count_ = 1;
  std::size_t damage_ = 0;
};

/// 50 x 50 x 2.5 mm, 1680 elements; five rows of cells around y = 26 can tear, and the lower right
/// corner is pulled. All else lies outside a condensed region.
Scene organ(const Way& way) {
  Scene scene;
  scene.mesh = structured_board({14, 20, 1, 50, 50, 2.5}, [](const Vec3& x) {
    return x.y() > 20 && x.y() < 32.5 ? "tissue" : "organ";
  });
  scene.materials = {{"tissue", {5, 0.4, 2.0}}, {"organ", {5, 0.4, std::nullopt}}};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  Instrument forceps;
  forceps.action = Pull{lower_right_corner(), Vec3(0, -60, 0)};
  scene.instruments.push_back(forceps);
  scene.fracture.model = FractureModel::b;
  scene.solver.backend = "cpu";
  scene.solver.route = way.route;
  scene.solver.update = way.update;
  return scene;
}

/// A pull that turns: along y alone, in the plane, in space; once with a force outside the region.
std::vector<Load> turning_pull(const Problem& problem) {
  const Mesh& mesh = problem.mesh();
  const Index outside = nodes_in(mesh, {Vec3(-0.1, 9.9, -1), Vec3(0.1, 10.1, 3)}).front();
  std::vector<Load> loads;
  for (int i = 0; i < 8; ++i) {
    const double angle = 0.4 * (i - i % 2);
    const Vec3 force(20 * std::sin(angle), -20 * std::cos(angle), i < 4 ? 0 : 3 * i);
    std::vector<double> nodal = corner_force(mesh, force);
    if (i == 6) nodal[3 * static_cast<std::size_t>(outside)] = -4;
    loads.push_back(load_of(problem, nodal, {}));
  }
  return loads;
}

class TornFrames : public ::testing::TestWithParam<Way> {};

// The backend's frames, everything read in each. Two of them are the warm-up.
TEST_P(TornFrames, AllocateNothingOnceTheyAreWarm) {
  const bool deferred = GetParam().update == Update::deferred;
  const Body body(organ(GetParam()));
  const std::vector<Load> loads = turning_pull(*body.problem);
  std::vector<double> u(body.problem->dofs().size());
  std::vector<Voigt> stress(body.problem->mesh().tets.size());
  const auto sequence = crack_sequence(*body.problem, deferred ? 320 : 60, 8);
  Bases bases;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const Count counted;
    body.backend->destroy({&sequence[i], 1});
    body.backend->set_load(loads[i / 2 % loads.size()]);
    body.backend->solve();
    body.backend->stress();
    body.backend->read_displacement(u);
    body.backend->read_stress(stress);
    const long sum = i < 2 ? 0 : counted.sum();
    EXPECT_EQ(sum, 0) << "fracture " << i;
    bases.look_at(*body.backend);
  }
  EXPECT_GE(bases.count(), deferred ? 3 : 1);
}

INSTANTIATE_TEST_SUITE_P(Routes, TornFrames, every_way(),
                         [](const auto& p) { return p.param.name; });

struct TornRoute {
  const char* name;
  Route route;
  FractureModel model = FractureModel::b;
  SifSource sif = SifSource::formula;
  Update update = Update::deferred;
};

constexpr int kCut = 280, kTorn = 20;  // steps
constexpr int kMost = 80;              // elements torn; soon the board is in two

/// The notched board, held at its lower left corner. A scalpel takes an element in every step and
/// widens a slit from the right edge; then the forceps pull the notch open.
Scene slit_board(const TornRoute& tear) {
  Scene scene = notch_board(tear.model);
  scene.instruments[0].ramp.reset();
  Instrument grip;
  grip.action =
      Grip{Box{Vec3(-0.001, -0.001, -1), Vec3(0.001, 0.001, 3)}, Vec3::Constant(1e-4), Axes{7}};
  scene.instruments.push_back(grip);
  std::vector<std::uint8_t> taken(scene.mesh.tets.size(), 0);
  int step = 0;
  for (double height : {38.0, 39.5, 36.5, 41.0, 35.0, 42.5}) {
    for (Index e : elements_across(scene.mesh, height)) {
      if (step == kCut || taken[e] || centroid(scene.mesh, e).x() < 15) continue;
      taken[e] = 1;
      scene.removals.push_back({step++, std::vector<Index>{e}});
    }
  }
  scene.solver.route = tear.route;
  scene.solver.update = tear.update;
  scene.fracture.sif = tear.sif;
  scene.steps = kCut + kTorn;
  return scene;
}

class TornSteps : public ::testing::TestWithParam<TornRoute> {};

// All of a step, on two bases or more; the load turns while the slit is cut. Two steps are the
// warm-up.
TEST_P(TornSteps, AllocateNothingOnceTheyAreWarm) {
  const auto problem = std::make_shared<const Problem>(slit_board(GetParam()));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  Bases bases;
  int before = 0, torn = 0;
  while (!simulation.done() && torn < kMost) {
    const int step = simulation.steps_done();
    const double angle = 0.1 * (step % 30), force = step < kCut ? 1 : 60.0 * (step - kCut) / kTorn;
    simulation.drive(0, step < kCut ? Vec3(force * std::sin(angle), -force * std::cos(angle), 0)
                                    : Vec3(0, -force, 0));
    const Count counted;
    const StepReport report = simulation.step();
    const long sum = step < 2 ? 0 : counted.sum();
    EXPECT_EQ(sum, 0) << "step " << step << ", " << report.destroyed - before << " elements";
    if (step >= kCut) torn += report.destroyed - before;
    before = report.destroyed;
    bases.look_at(simulation.backend());
  }
  EXPECT_GT(torn, 0);
  EXPECT_GE(bases.count(), 2);
}

INSTANTIATE_TEST_SUITE_P(Slit, TornSteps,
                         ::testing::Values(TornRoute{"Inverse", Route::inverse},
                                           TornRoute{"Condensed", Route::condensed},
                                           TornRoute{"Factor", Route::factor, FractureModel::a},
                                           TornRoute{"CondensedByField", Route::condensed,
                                                     FractureModel::b, SifSource::field},
                                           TornRoute{"CondensedByShear", Route::condensed,
                                                     FractureModel::a}),
                         [](const auto& p) { return p.param.name; });

}  // namespace
}  // namespace sunder::test
