// SPDX-License-Identifier: Apache-2.0
// K of every tip, growing, resting and ended: Simulation::tips against the rows of the events that
// follow, and against a meter of its own.
#include <gtest/gtest.h>

#include <map>

#include "core/field_sif/held_strip.hpp"
#include "fracture/field_sif/field_intensity.hpp"
#include "fracture/field_sif/tangential_stress.hpp"

namespace sunder {
namespace {

struct Tearing {
  explicit Tearing(Scene scene) : Tearing(std::make_shared<const Problem>(std::move(scene))) {}
  explicit Tearing(std::shared_ptr<const Problem> p)
      : problem(std::move(p)),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

class Tips : public testing::TestWithParam<SifSource> {
 protected:
  [[nodiscard]] static Scene scene(const Vec3& displacement) {
    return test::HeldStrip{}.scene(GetParam(), displacement);
  }
};

TEST_P(Tips, BeforeADecisionAreWhatItsRowsSay) {
  Tearing run(scene({0, 8, 0}));
  Simulation& simulation = run.simulation;
  std::vector<std::vector<TipState>> before;  // by event
  simulation.observe_frames([&] {
    const auto event = simulation.destroyed().empty() ? 0 : simulation.destroyed().back().event;
    before.resize(static_cast<std::size_t>(event) + 1);
    before.back() = simulation.tips();
  });
  for (int step = 0; step < 16; ++step) simulation.step();
  int compared = 0;
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (!row.sif) continue;
    const TipState& tip = before.at(static_cast<std::size_t>(row.event) - 1).at(0);
    EXPECT_EQ(tip.k, row.sif->k);
    EXPECT_EQ(tip.theta, row.sif->theta);
    EXPECT_EQ(tip.field_note, GetParam() == SifSource::field ? row.sif->field_note : "");
    EXPECT_EQ(tip.k_1.has_value(), GetParam() == SifSource::field);
    if (tip.k_1) {
      EXPECT_EQ(tip.k_1, row.sif->k_1);
    }
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST_P(Tips, ChangeNoResult) {
  Tearing asked(scene({0, 8, 0})), alone(scene({0, 8, 0}));
  for (int step = 0; step < 8; ++step) {
    asked.simulation.step();
    EXPECT_EQ(asked.simulation.tips().size(), asked.simulation.cracks().size());
    alone.simulation.step();
  }
  ASSERT_EQ(asked.simulation.destroyed().size(), alone.simulation.destroyed().size());
  for (std::size_t i = 0; i < asked.simulation.destroyed().size(); ++i)
    EXPECT_EQ(asked.simulation.destroyed()[i].element, alone.simulation.destroyed()[i].element);
  EXPECT_EQ(asked.simulation.displacement(), alone.simulation.displacement());
  EXPECT_EQ(asked.simulation.warnings(), alone.simulation.warnings());
}

TEST_P(Tips, RestingOnesHaveTheirK) {
  // Too little for anything to break: K is linear in the load.
  Tearing run(scene({0, 0.4, 0}));
  EXPECT_TRUE(run.simulation.tips().empty());  // nothing is solved yet
  std::vector<double> k;
  for (int step = 0; step < 3; ++step) {
    run.simulation.step();
    const auto tips = run.simulation.tips();
    ASSERT_EQ(tips.size(), 1u);
    EXPECT_EQ(tips[0].position, Vec3(6, 10.5, 0.5));
    ASSERT_TRUE(tips[0].k && tips[0].theta);
    k.push_back(*tips[0].k);
  }
  EXPECT_EQ(run.simulation.destroyed().back().cause, Cause::preset);
  EXPECT_GT(k[0], 0);
  EXPECT_NEAR(k[1] / k[0], 2, 1e-9);
  EXPECT_NEAR(k[2] / k[0], 3, 1e-9);
}

TEST_P(Tips, EndedOnesKeepTheirRowWithoutK) {
  Tearing run(scene({0, 30, 0}));
  Simulation& simulation = run.simulation;
  simulation.step();
  while (!simulation.done() && !simulation.cracks().at(0).tips[0].ended) simulation.step();
  ASSERT_TRUE(simulation.cracks()[0].tips[0].ended);
  const TipState tip = simulation.tips().at(0);
  EXPECT_TRUE(tip.ended);
  EXPECT_FALSE(tip.k || tip.theta || tip.k_1 || tip.k_2 || tip.k_3);
}

INSTANTIATE_TEST_SUITE_P(By, Tips, testing::Values(SifSource::formula, SifSource::field),
                         [](const auto& tested) {
                           return tested.param == SifSource::field ? "Field" : "Formula";
                         });

TEST(AllTips, OfRestingOnesAgreeWithAMeterOfItsOwn) {
  // Models B and none: nothing but the field decides.
  for (const FractureModel model : {FractureModel::b, FractureModel::none}) {
    Scene scene = test::HeldStrip{}.scene(SifSource::field, {0.3, 0.4, 0});
    scene.fracture.model = model;
    Tearing run(std::move(scene));
    Simulation& simulation = run.simulation;
    simulation.step();
    const fracture::Board board(run.problem->mesh(), {});
    fracture::FieldIntensityMeter meter(*run.problem, board);
    // The grip is outside the ring.
    const auto k = meter
                       .at(simulation.cracks()[0], 0,
                           {simulation.backend().destroyed(),
                            [&](std::span<const Index> nodes, std::span<Vec3> u) {
                              simulation.backend().read_displacement(nodes, u);
                            },
                            {}})
                       .factors;
    const auto tips = simulation.tips();
    ASSERT_EQ(tips.size(), 1u);
    EXPECT_EQ(tips[0].k_1, k.k_1);
    EXPECT_EQ(tips[0].k_2, k.k_2);
    EXPECT_EQ(tips[0].k_3, k.k_3);
    const double theta = fracture::tangential_angle(k.k_1, k.k_2);
    EXPECT_EQ(tips[0].k, fracture::tangential_intensity(k.k_1, k.k_2, theta));
  }
}

TEST(AllTips, NoneOfModelA) {
  Scene scene = test::HeldStrip{}.scene(SifSource::formula, {0, 0.4, 0});
  scene.fracture.model = FractureModel::a;
  Tearing run(std::move(scene));
  run.simulation.step();
  EXPECT_TRUE(run.simulation.tips().empty());
}

}  // namespace
}  // namespace sunder
