// SPDX-License-Identifier: Apache-2.0
// Summaries of more partial results than one workgroup joins: largest values exactly, sums to
// rounding, the same bits every time.
#include "gpu/passes/summary.hpp"
#include "kernels_fixture.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder::test {
namespace {

class Summaries : public Kernels {
 protected:
  struct Parts {
    std::vector<shaders::StressPartial> elements;
    std::vector<shaders::NodePartial> nodes;
  };
  Parts random_parts(std::size_t element_count, std::size_t node_count) {
    Parts parts{std::vector<shaders::StressPartial>(element_count),
                std::vector<shaders::NodePartial>(node_count)};
    std::uint32_t i = 0;
    for (auto& e : parts.elements) {
      const double ratio = std::abs(random());
      e = {ratio, ratio / 2, std::abs(random()), 5 * i, 5 * i + 1, i % 1000, (7 * i) % 1000,
           i % 3, 0.5f};
      ++i;
    }
    for (auto& n : parts.nodes) n = {std::abs(random()), std::abs(random()), std::abs(random()), 0};
    return parts;
  }
  /// By gpu::SummaryPass; the second one, which leaves the list alone.
  shaders::Summary summary(const Parts& parts) {
    const auto of_elements = buffer(parts.elements), of_nodes = buffer(parts.nodes);
    const auto over = buffer(Words(8, 5)), summaries = empty(20);
    const gpu::SummaryParts count{static_cast<std::uint32_t>(parts.elements.size()),
                                  static_cast<std::uint32_t>(parts.nodes.size())};
    const gpu::SummaryPass pass(*factory_, count, {of_elements, of_nodes, summaries, over});
    EXPECT_EQ(pass.bytes(), gpu::SummaryPass::planned_bytes(*factory_, count));
    EXPECT_EQ(pass.bytes() > 0, in_two(count));
    vulkan::Commands commands(*device_);
    commands.begin();
    pass.record(commands, count, 1);
    commands.end();
    const std::size_t before = device_->dispatches();
    commands.submit();
    EXPECT_EQ(device_->dispatches() - before, in_two(count) ? 2u : 1u);
    return read<shaders::Summary>(summaries, 2)[1];
  }
  [[nodiscard]] bool in_two(const gpu::SummaryParts& parts) const {
    return std::max(parts.elements, parts.nodes) > (factory_->emulated() ? 8192u : 1024u);
  }
};

TEST_P(Summaries, OfPartsOfManyWorkgroups) {
  // One each; two by elements, and by nodes, alone; no multiples of 256.
  for (const auto& [elements, nodes] :
       {std::pair{1000, 300}, std::pair{9001, 2999}, std::pair{255, 8300}}) {
    SCOPED_TRACE(elements);
    Parts parts = random_parts(static_cast<std::size_t>(elements), static_cast<std::size_t>(nodes));
    // The worst twice, in different workgroups: the lower element; and not a candidate.
    const std::size_t last = parts.elements.size() - 1;
    parts.elements[last].any_ratio = parts.elements[3].any_ratio = 2;
    parts.elements[last].candidate_ratio = 1.5;
    const shaders::Summary s = summary(parts);
    EXPECT_EQ(s.any_ratio, 2);
    EXPECT_EQ(s.any_element, 15u);
    EXPECT_EQ(s.candidate_ratio, 1.5);
    EXPECT_EQ(s.candidate_element, 5 * last + 1);
    EXPECT_EQ(s.over, 5u);
    double stress = 0, residual = 0, reaction = 0, largest = 0;
    std::uint32_t strain = 0, half_tangent = 0, inverted = 0;
    for (const auto& e : parts.elements) {
      stress = std::max(stress, e.stress_squared);
      strain = std::max(strain, e.strain);
      half_tangent = std::max(half_tangent, e.half_tangent);
      inverted += e.inverted;
    }
    for (const auto& n : parts.nodes) {
      residual += n.residual_squared;
      reaction += n.reaction_squared;
      largest = std::max(largest, n.largest_u);
    }
    EXPECT_EQ(s.stress_squared, stress);
    EXPECT_EQ(s.strain, strain);
    EXPECT_EQ(s.half_tangent, half_tangent);
    EXPECT_EQ(s.inverted, inverted);
    EXPECT_EQ(s.largest_u, largest);
    EXPECT_EQ(s.handed_out, 0.5f);
    const double rounding = static_cast<double>(nodes) * kEps64;
    EXPECT_NEAR(s.residual_squared, residual, rounding * residual);
    EXPECT_NEAR(s.reaction_squared, reaction, rounding * reaction);
    const shaders::Summary again = summary(parts);
    EXPECT_EQ(again.residual_squared, s.residual_squared);
    EXPECT_EQ(again.reaction_squared, s.reaction_squared);
  }
}

// 66,150 elements: 1,034 workgroups of the stress pass, of which gpu leaves one partial result
// each.
TEST_P(Summaries, OfABodyOfManyWorkgroups) {
  if (GetParam().variant == gpu::Variant::lvp || !GetParam().fp64) {
    GTEST_SKIP() << "a variant and a precision are enough for a body of this size";
  }
  Scene scene;
  scene.mesh = structured_board({105, 105, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.99, -1), Vec3(11, 10.01, 2)}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs());
  std::vector<double> u(3 * problem.mesh().nodes.size());
  for (double& v : u) v = 1e-3 * random();
  fields.write_displacement(u);
  compute_state(fields);
  const shaders::Summary s = fields.state();
  std::vector<Voigt> stress(problem.mesh().tets.size());
  fields.read_stress(stress);
  double largest = 0;
  for (const Voigt& of : stress) largest = std::max(largest, tensor(of).squaredNorm());
  EXPECT_NEAR(s.stress_squared, largest, 1e-14 * largest);
  const auto unknowns = static_cast<std::size_t>(problem.dof_count());
  double residual = 0;
  for (const double r : read(fields.residual(), unknowns)) residual += r * r;
  EXPECT_GT(residual, 0);
  EXPECT_NEAR(s.residual_squared, residual, static_cast<double>(unknowns) * kEps64 * residual);
  compute_state(fields);
  EXPECT_EQ(fields.state().residual_squared, s.residual_squared);
}

INSTANTIATE_TEST_SUITE_P(All, Summaries,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::gpu, false},
                                         Numbers{gpu::Variant::lvp, true},
                                         Numbers{gpu::Variant::lvp, false}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
