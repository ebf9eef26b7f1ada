// SPDX-License-Identifier: Apache-2.0
#include "verification/first_growth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "app/reproduce/notch_mesh.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "fracture/band.hpp"
#include "fracture/crack_birth.hpp"
#include "fracture/stress_intensity.hpp"
#include "sunder/simulation.hpp"
#include "support/notch_board.hpp"

namespace sunder::test {
namespace {

constexpr double kSide = kGmshBoardSide, kNotch = 10, kHole = 5;  // mm
constexpr double kEnd = 1e-6;                                     // mm

Box end(double y) { return {Vec3(-1, y - kEnd, -1), Vec3(kSide + 1, y + kEnd, 9)}; }

Scene board_of(Mesh mesh) {
  Scene scene;
  scene.mesh = std::move(mesh);
  scene.materials["board"] = {5, 0.4, {}};
  scene.fracture.alpha = 1e-9;
  scene.fracture.sif = SifSource::field;
  scene.solver.backend = "cpu";
  return scene;
}

Instrument grip_at(double y, const Vec3& displacement, const char* name, bool rigid = false) {
  Instrument grip;
  grip.name = name;
  grip.action = Grip{end(y), displacement, Axes{7}, rigid};
  return grip;
}

void add_notch(Scene& scene, double size, double length) {
  PresetCrack notch;
  const double middle = kSide / 2;
  notch.elements = Box{Vec3(-1, middle - size / 2, -1), Vec3(length, middle + size / 2, 9)};
  notch.mouth = Vec3(0, middle, 1);
  notch.tips = {Vec3(length, middle, 1)};
  scene.cracks.push_back(notch);
  scene.fracture.model = FractureModel::b;
}

/// Lower end held, upper end moved by a little: nothing breaks.
void pull_a_little(Scene& scene) {
  scene.supports.push_back({end(0), Axes{7}});
  scene.instruments.push_back(grip_at(kSide, Vec3(0, 0.01, 0), "grip"));
}

/// The ends move along the board alone and are free across it: clamped corners would break first.
void pull_on_rollers(Scene& scene) {
  scene.supports.push_back({end(0), Axes{2}});
  scene.supports.push_back({Ball{Vec3(0, 0, 0), kEnd}, Axes{5}});
  scene.supports.push_back({Ball{Vec3(kSide, 0, 0), kEnd}, Axes{4}});
  Instrument grip = grip_at(kSide, Vec3(0, 0.01, 0), "grip");
  std::get<Grip>(grip.action).axes = Axes{2};
  scene.instruments.push_back(grip);
}

struct BoardSimulation {
  explicit BoardSimulation(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

/// K at which Eq. 1's reach passes the first element ahead of the notch.
double intensity_of_reach(const Problem& problem, double h) {
  const fracture::Board board(problem.mesh(), {});
  const auto& elements = problem.crack_elements()[0];
  const Crack crack = fracture::preset_crack(board, problem.scene().cracks[0], 0, elements);
  std::vector<std::uint8_t> destroyed(problem.mesh().tets.size(), 0);
  for (Index e : elements) destroyed[static_cast<std::size_t>(e)] = 1;
  const std::vector<double> yields(destroyed.size(), kBoardYield);
  fracture::BandSearch bands(board);
  const auto& band =
      bands.find({crack.tips[0].position, crack.tips[0].direction, &crack, 1}, {destroyed, yields});
  const double distance = std::max(band.elements.at(0).rho, h / 2);
  return std::sqrt(distance / fracture::reach(1, kBoardYield, 0));  // r goes with K^2
}

}  // namespace

NotchedBoard notched_board(double size, double notch) {
  Scene scene = board_of(gmsh_board({.size = size, .notch = notch}));
  add_notch(scene, size, notch);
  pull_a_little(scene);
  scene.materials["board"].toughness = 1e9;
  BoardSimulation run(std::move(scene));
  run.simulation.step();
  const TipState tip = run.simulation.tips().at(0);
  if (!tip.k || !(*tip.k > 0)) throw std::runtime_error("no K on the notched board");
  const double per_k = run.simulation.reactions().at(0).y() / *tip.k;
  NotchedBoard board;
  board.tets = run.problem->tet_count();
  board.h = fracture::Board(run.problem->mesh(), {}).h();
  board.force = kBoardToughness * per_k;
  board.force_by_eq1 = intensity_of_reach(*run.problem, board.h) * per_k;
  return board;
}

GrownBoard grown_board(double size) {
  Scene scene = board_of(gmsh_board({.size = size, .notch = kNotch}));
  add_notch(scene, size, kNotch);
  scene.supports.push_back({end(0), Axes{7}});
  // As far as it ever goes from the first step on, so that the crack grows once in each.
  Instrument grip = grip_at(kSide, Vec3(1.5, 5, 0), "grip");
  scene.steps = 200;
  grip.ramp = Ramp{0, 1.0 / scene.steps};
  scene.instruments.push_back(grip);
  scene.materials["board"].toughness = kBoardToughness;
  scene.fracture.crack = CrackWay::split;
  scene.fracture.max_events = 1;
  BoardSimulation run(std::move(scene));
  GrownBoard board;
  board.tets = run.problem->tet_count();
  board.h = fracture::Board(run.problem->mesh(), {}).h();
  std::array<double, 3> before{};
  while (board.force.size() < std::size(kGrownTo)) {
    run.simulation.step();
    const TipState tip = run.simulation.tips().at(0);
    // Linear: the force and K go together.
    const std::array<double, 3> now{
        tip.position.x(), run.simulation.reactions().at(0).norm() * kBoardToughness / tip.k.value(),
        tip.position.y()};
    while (board.force.size() < std::size(kGrownTo) && now[0] >= kGrownTo[board.force.size()]) {
      const double share = (kGrownTo[board.force.size()] - before[0]) / (now[0] - before[0]);
      board.force.push_back(before[1] + share * (now[1] - before[1]));
      board.y.push_back(before[2] + share * (now[2] - before[2]));
    }
    before = now;
  }
  return board;
}

PaperBoard paper_board(double size) {
  Scene scene = notch_board(FractureModel::b);
  scene.mesh = *app::reproduce::mesh_notch({.size = size});
  for (auto& [name, material] : scene.materials) material.toughness = 1e9;
  scene.fracture.sif = SifSource::field;
  scene.steps = 1;
  scene.solver.backend = "cpu";
  scene.instruments[0].action = Pull{lower_right_corner(), Vec3(0, -1, 0)};
  BoardSimulation run(std::move(scene));
  run.simulation.step();
  const TipState tip = run.simulation.tips().at(0);
  PaperBoard board;
  board.tets = run.problem->tet_count();
  board.force = kBoardToughness / *tip.k;
  board.force_by_eq1 =
      intensity_of_reach(*run.problem, fracture::Board(run.problem->mesh(), {}).h()) / *tip.k;
  return board;
}

TurnedBoard turned_board(double size) {
  constexpr double kTurn = 30, kTurnSteps = 3;
  Scene scene = board_of(gmsh_board({.size = size, .notch = kNotch}));
  add_notch(scene, size, kNotch);
  scene.materials["board"].law = MaterialLaw::corotated;
  scene.materials["board"].energy = 1e9;
  scene.instruments.push_back(grip_at(0, Vec3::Zero(), "lower", true));
  scene.instruments.push_back(grip_at(kSide, Vec3::Zero(), "upper", true));
  scene.steps = 100;
  BoardSimulation run(std::move(scene));
  TurnedBoard board;
  board.tets = run.problem->tet_count();
  // The lower end turns about its middle, the upper one goes with it and then away along the board.
  const auto go = [&](double degrees, double extension) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 along(-std::sin(angle), std::cos(angle), 0);
    run.simulation.turn(0, Vec3(0, 0, degrees));
    run.simulation.turn(1, Vec3(0, 0, degrees));
    run.simulation.drive(1, (kSide + extension) * along - Vec3(0, kSide, 0));
    StepReport report = run.simulation.step();
    while (report.unfinished) report = run.simulation.step();
    board.rotation = report.deformation->rotation_deg;
    board.extension = extension;
    board.force = run.simulation.reactions().at(1).dot(along);
    const TipState tip = run.simulation.tips().at(0);
    board.strain = tip.field_note == "strain";
    return *tip.j;
  };
  for (int i = 1; i <= kTurnSteps; ++i) go(kTurn * i / kTurnSteps, 0.0);
  // J grows nearly with the square of the extension.
  double extension = 1;
  for (double j = go(kTurn, extension); std::abs(j / kBoardEnergy - 1) > 1e-4;
       j = go(kTurn, extension))
    extension *= std::sqrt(kBoardEnergy / j);
  return board;
}

HoledBoard holed_board(double size) {
  const auto force = [&](double averaging, Index* tets) {
    Scene scene = board_of(gmsh_board({.size = size, .hole = kHole}));
    pull_on_rollers(scene);
    scene.materials["board"].yield = kBoardYield;
    scene.fracture.model = FractureModel::a;
    scene.fracture.averaging = averaging;
    BoardSimulation run(std::move(scene));
    const StepReport report = run.simulation.step();
    if (tets) *tets = run.problem->tet_count();
    return run.simulation.reactions().at(0).y() / report.max_yield_ratio;
  };
  HoledBoard board;
  board.force = force(kBoardAveraging, &board.tets);
  board.force_by_element = force(0, nullptr);
  return board;
}

}  // namespace sunder::test
