// SPDX-License-Identifier: Apache-2.0
// The worked example of docs/method.md, read from that page and computed again: once step by step
// through the fracture functions, once by the frame.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <sstream>

#include "fracture/band.hpp"
#include "fracture/crack_birth.hpp"
#include "fracture/geometry_factor.hpp"
#include "fracture/pristine_field.hpp"
#include "fracture/stress_intensity.hpp"
#include "fracture/tip_growth.hpp"
#include "sunder/backends.hpp"
#include "sunder/simulation.hpp"
#include "support/msh_reader.hpp"

namespace sunder::fracture {
namespace {

/// The page prints ten digits.
constexpr double kRelativelyPrinted = 6e-10;  // relative

/// What the page's section says: "| name | value | ..." rows and the list of elements.
class Page {
 public:
  Page() {
    std::ifstream in(SUNDER_SOURCE "/docs/method.md");
    std::string line;
    bool inside = false;
    while (std::getline(in, line)) {
      inside = inside || line.starts_with("## Worked example");
      if (!inside) continue;
      if (line.starts_with("| ")) add_row(line);
      if (line.starts_with("Destroyed, in order of rho:")) add_elements(line);
      if (line.starts_with("The walk stops at element ")) survivor_ = line;
    }
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& name) const {
    std::string text = rows_.at(name);
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream in(text);
    std::vector<double> values;
    for (double v = 0; in >> v;) values.push_back(v);
    return values;
  }
  [[nodiscard]] double number(const std::string& name) const { return numbers(name).at(0); }
  [[nodiscard]] const std::vector<Index>& elements() const { return elements_; }
  /// Element and rho of the sentence about the survivor.
  [[nodiscard]] std::pair<Index, double> survivor() const {
    std::istringstream in(survivor_.substr(survivor_.find("element ") + 8));
    std::pair<Index, double> out{kNone, 0};
    std::string ignored;
    in >> out.first >> ignored >> ignored >> ignored >> out.second;
    return out;
  }

 private:
  void add_row(const std::string& line) {
    std::istringstream in(line);
    std::string bar, name, value;
    std::getline(in, bar, '|');
    std::getline(in, name, '|');
    std::getline(in, value, '|');
    rows_[name.substr(1, name.size() - 2)] = value;
  }
  void add_elements(const std::string& line) {
    std::istringstream in(line.substr(line.find(':') + 1));
    for (Index e = 0; in >> e;) elements_.push_back(e);
  }

  std::map<std::string, std::string> rows_;
  std::vector<Index> elements_;
  std::string survivor_;
};

std::shared_ptr<const Problem> notched_board() {
  Scene scene;
  scene.title = "Notched board pulled at the lower right corner";
  scene.mesh = test::read_msh22(SUNDER_SCENES "/meshes/board1954_notch.msh");
  scene.materials = {{"upper", {5, 0.4, 2.0}},
                     {"preset-crack", {5, 0.4, 2.0}},
                     {"lower", {8, 0.4, 4.0}},
                     {"top-frame", {500, 0.4, std::nullopt}},
                     {"bottom-frame", {500, 0.4, std::nullopt}}};
  scene.supports = {{Box{Vec3(-1, 49.999, -1), Vec3(51, 50.001, 3)}, Axes{7}}};
  const Box corner{Vec3(49.999, -0.001, -1), Vec3(50.001, 0.001, 3)};
  scene.instruments = {{"right forceps", Pull{corner, Vec3(0, -60, 0)}, Ramp{0, 1}}};
  scene.cracks = {{VolumeName{"preset-crack"}, Vec3(50, 25, 1), {Vec3(45.96, 25, 1)}}};
  scene.fracture.model = FractureModel::b;
  scene.solver.backend = "cpu";
  scene.steps = 40;
  return std::make_shared<const Problem>(std::move(scene));
}

/// Pull on the corner at scene time t.
Load corner_load(const Problem& problem, double t) {
  Load load;
  const auto& nodes = problem.instrument_nodes()[0].nodes;
  for (Index n : nodes) {
    load.force_dofs.push_back(problem.dof(n, 1));
    load.forces.push_back(-60 * t / static_cast<double>(nodes.size()));
  }
  return load;
}

void expect_printed(double value, double printed) {
  EXPECT_NEAR(value, printed, kRelativelyPrinted * std::abs(printed));
}

TEST(WorkedExample, StepByStep) {
  const Page page;
  const auto problem = notched_board();
  const Board board(problem->mesh(), std::nullopt);
  expect_printed(board.h(), page.number("h"));

  const auto created = create_backend(problem, needs_of(*problem));
  const double t = (page.number("step") + 1) / 40;
  std::vector<double> pristine(3 * problem->mesh().nodes.size());
  created.backend->solve_pristine(corner_load(*problem, t), pristine);

  const Crack crack =
      preset_crack(board, problem->scene().cracks[0], 0, problem->crack_elements()[0]);
  std::vector<std::uint8_t> destroyed(problem->mesh().tets.size(), 0);
  for (Index e : crack.elements) destroyed[e] = 1;
  const FractureState state{*problem, destroyed, {}, {}, {}, Vec3(0, -60 * t, 0), {}};
  std::vector<Finding> findings;
  FacePressure faces;
  face_pressure(board, crack, state, findings, faces);
  const PristineField field(*problem, board, pristine);
  const auto growth = tip_growth(board, field, crack, 0, faces, state);
  ASSERT_TRUE(growth);
  const SifTerms& k = growth->terms;
  expect_printed(k.a, page.number("a"));
  expect_printed(k.b, page.number("b"));
  expect_printed(edge_factor(k.a / k.b), page.number("F"));
  expect_printed(k.sigma0, page.number("s0"));
  expect_printed(k.beta, page.number("beta"));
  expect_printed(k.k_a, page.number("K_a"));
  EXPECT_EQ(k.k, k.k_a);
  expect_printed(k.theta, page.number("theta"));
  expect_printed(reach(k.k, 2, growth->theta), page.number("r_e at yield 2"));
  expect_printed(reach(k.k, 4, growth->theta), page.number("r_e at yield 4"));

  std::vector<double> yields;
  for (Index e = 0; e < problem->tet_count(); ++e) yields.push_back(problem->yield(e));
  const ElementView view{destroyed, yields};
  BandSearch bands(board);
  const Vec2 p = crack.tips[0].position;
  const Band& band = bands.find({p, growth->direction, &crack, 1}, view);
  EXPECT_EQ(band.near_side, page.number("near nodes"));
  Walk walk;
  walk_band(band, board.h(), k.k, growth->theta, view, walk);
  std::vector<Index> passed;
  for (const Passed& e : walk.passed) passed.push_back(e.element);
  EXPECT_EQ(passed, page.elements());
  const auto [survivor, rho] = page.survivor();
  ASSERT_GT(band.elements.size(), passed.size());
  EXPECT_EQ(band.elements[passed.size()].element, survivor);
  expect_printed(band.elements[passed.size()].rho, rho);
  expect_printed(walk.advance, page.number("advance"));
  const Vec2 after = p + walk.advance * growth->direction;
  ASSERT_EQ(page.numbers("p after").size(), 2u);
  expect_printed(after.x(), page.numbers("p after")[0]);
  expect_printed(after.y(), page.numbers("p after")[1]);
}

TEST(WorkedExample, AsTheFrameDoesIt) {
  const Page page;
  const auto problem = notched_board();
  Simulation simulation(problem, create_backend(problem, needs_of(*problem)).backend);
  const int step = static_cast<int>(page.number("step"));
  while (simulation.steps_done() < step) simulation.step();
  const std::size_t presets = problem->crack_elements()[0].size();
  EXPECT_EQ(simulation.destroyed().size(), presets) << "nothing grows before step " << step;
  const auto resting = simulation.tips();
  ASSERT_EQ(resting.size(), 1u);
  expect_printed(resting[0].k.value(),
                 page.number("K_a") * step / (step + 1));  // linear in the load
  expect_printed(resting[0].theta.value(), page.number("theta"));
  EXPECT_NEAR(resting[0].position.x(), 45.96, 1e-12);
  simulation.step();
  std::vector<Index> first;
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (row.event != 1) continue;
    EXPECT_EQ(row.step, step);
    EXPECT_EQ(row.cause, Cause::sif);
    expect_printed(row.sif->k, page.number("K_a"));
    expect_printed(*row.ratio, page.number("r_e at yield 2") / (page.number("h") / 2));
    first.push_back(row.element);
  }
  EXPECT_EQ(first, page.elements());
  const Vec2 after = simulation.cracks()[0].path.at(2);
  expect_printed(after.x(), page.numbers("p after")[0]);
  expect_printed(after.y(), page.numbers("p after")[1]);
}

}  // namespace
}  // namespace sunder::fracture
