// SPDX-License-Identifier: Apache-2.0
// K measured from the field on Vulkan: the same as on the CPU, from nothing but the ring of nodes
// round each tip.
#include <cmath>

#include "fracture/board.hpp"
#include "fracture/crack_birth.hpp"
#include "fracture/field_sif/field_intensity.hpp"
#include "gpu_body.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

// u is right to these errors (2-norm over nodes; the accuracy table, along a crack); K is linear
// in the u of a ring that bends little, hence the factor for the ring's strain against u itself.
constexpr double kFp64 = 1e-8, kFp32 = 1e-4;
constexpr double kStrainOfU = 10;

/// A board with a notch of destroyed elements in its right edge.
Scene notched(bool gripped) {
  const BoardShape shape{24, 24, 1, 24, 24, 1};
  Scene scene;
  scene.mesh = structured_board(shape);
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 23.99, -1), Vec3(25, 24.01, 2)}, Axes{7}});
  Instrument pull;
  pull.name = "forceps";
  if (gripped) {
    pull.action = Grip{Box{Vec3(17.9, -0.1, -1), Vec3(24.1, 0.1, 2)}, Vec3(1, -2, 0.1), Axes{7}};
  } else {
    pull.action = Pull{Box{Vec3(17.9, -0.1, -1), Vec3(24.1, 0.1, 2)}, Vec3(2, -14, 0.1)};
  }
  scene.instruments.push_back(pull);
  PresetCrack notch;
  notch.elements = Box{Vec3(17, 12, -1), Vec3(25, 13, 2)};
  notch.mouth = Vec3(24, 12.5, 0.5);
  notch.tips = {Vec3(17, 12.5, 0.5)};
  scene.cracks.push_back(notch);
  scene.fracture.model = FractureModel::b;
  scene.fracture.sif = SifSource::field;
  scene.steps = 1;
  return scene;
}

class FieldSif : public WithVulkan<testing::TestWithParam<Way>> {
 protected:
  [[nodiscard]] double tolerance() const {
    return kStrainOfU * (GetParam().precision == Precision::fp64 ? kFp64 : kFp32);
  }
};

TEST_P(FieldSif, IsThatOfTheCpu) {
  Pair pair(notched(false), GetParam());
  const Problem& problem = pair.problem();
  pair.load(pull(problem, problem.instrument_nodes()[0].nodes, Vec3(2, -14, 0.1)));
  const fracture::Board board(problem.mesh(), {});
  fracture::FieldIntensityMeter meter(problem, board);
  const auto& elements = problem.crack_elements()[0];
  const Crack crack = fracture::preset_crack(board, problem.scene().cracks[0], 0, elements);
  pair.destroy(elements);
  pair.solve();
  const auto measure = [&](const Backend& backend) {
    return meter
        .at(crack, 0,
            {backend.destroyed(),
             [&](std::span<const Index> nodes, std::span<Vec3> u) {
               backend.read_displacement(nodes, u);
             },
             {}})
        .factors;
  };
  const auto expected = measure(*pair.reference), k = measure(*pair.vulkan);
  ASSERT_GT(expected.k_1, 1);
  EXPECT_GT(std::abs(expected.k_2), 0.05);
  EXPECT_NEAR(k.k_1, expected.k_1, tolerance() * expected.k_1);
  EXPECT_NEAR(k.k_2, expected.k_2, tolerance() * expected.k_1);
  EXPECT_NEAR(k.k_3, expected.k_3, tolerance() * expected.k_1);
}

TEST_P(FieldSif, ReadsNothingButTheRing) {
  Pair pair(notched(false), GetParam());
  const Problem& problem = pair.problem();
  pair.load(pull(problem, problem.instrument_nodes()[0].nodes, Vec3(2, -14, 0.1)));
  const fracture::Board board(problem.mesh(), {});
  fracture::FieldIntensityMeter meter(problem, board);
  const auto& elements = problem.crack_elements()[0];
  const Crack crack = fracture::preset_crack(board, problem.scene().cracks[0], 0, elements);
  pair.vulkan->destroy(elements);
  pair.vulkan->solve();
  std::size_t ring = 0;
  const std::size_t before = gpu::bytes_read(*pair.vulkan);
  (void)meter.at(crack, 0,
                 {pair.vulkan->destroyed(),
                  [&](std::span<const Index> nodes, std::span<Vec3> u) {
                    ring += nodes.size();
                    pair.vulkan->read_displacement(nodes, u);
                  },
                  {}});
  EXPECT_GT(ring, 100u);
  EXPECT_LT(2 * ring, problem.mesh().nodes.size());
  EXPECT_EQ(gpu::bytes_read(*pair.vulkan) - before, ring * sizeof(Vec3));
}

TEST_P(FieldSif, GripsHaveTheForcesOfTheCpu) {
  Pair pair(notched(true), GetParam());
  const Problem& problem = pair.problem();
  Load load;
  for (Index d : problem.gripped_dofs()) load.displacements.push_back(-0.1 * (1 + d % 3));
  pair.load(load);
  pair.destroy(problem.crack_elements()[0]);
  pair.solve();
  std::vector<double> expected(problem.gripped_dofs().size()), reactions(expected.size());
  pair.reference->read_reactions(expected);
  const std::size_t before = gpu::bytes_read(*pair.vulkan);
  pair.vulkan->read_reactions(reactions);
  EXPECT_EQ(gpu::bytes_read(*pair.vulkan) - before, expected.size() * sizeof(double));
  double largest = 0;
  for (double r : expected) largest = std::max(largest, std::abs(r));
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(reactions[i], expected[i], tolerance() * largest) << i;
}

std::vector<DestroyedElement> tear(const std::shared_ptr<const Problem>& problem,
                                   std::unique_ptr<Backend> backend) {
  Simulation simulation(problem, std::move(backend));
  while (!simulation.done() && simulation.destroyed().size() < 60) simulation.step();
  return simulation.destroyed();
}

using FieldSifRun = WithVulkan<>;

TEST_F(FieldSifRun, TearsAsOnTheCpu) {
  Scene scene = notched(false);
  scene.solver.backend = "cpu";
  const auto problem = std::make_shared<const Problem>(scene);
  const auto cpu = tear(problem, cpu_reference::create(problem, needs_of(*problem)));
  const WatchedBackend watched(scene, {});  // fp64
  const auto device = tear(watched.problem, watched.create());
  int compared = 0;
  ASSERT_EQ(device.size(), cpu.size());
  for (std::size_t i = 0; i < cpu.size(); ++i) {
    ASSERT_EQ(device[i].element, cpu[i].element) << i;
    ASSERT_EQ(device[i].sif.has_value(), cpu[i].sif.has_value());
    if (!cpu[i].sif) continue;
    const SifTerms &a = *device[i].sif, &b = *cpu[i].sif;
    EXPECT_NEAR(a.k, b.k, kStrainOfU * kFp64 * b.k);
    EXPECT_NEAR(*a.k_2, *b.k_2, kStrainOfU * kFp64 * b.k);
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

std::string way_name(const testing::TestParamInfo<Way>& way) {
  return way.param.route == Route::cg ? std::string("cg") : name_of(way.param);
}

INSTANTIATE_TEST_SUITE_P(Ways, FieldSif,
                         testing::Values(Way{gpu::Variant::lvp, Precision::fp64},
                                         Way{gpu::Variant::lvp, Precision::fp32},
                                         Way{gpu::Variant::gpu, Precision::fp64},
                                         Way{gpu::Variant::lvp, Precision::fp64, Update::automatic,
                                             1e-4, 0, Route::cg}),
                         way_name);

}  // namespace
}  // namespace sunder::test
