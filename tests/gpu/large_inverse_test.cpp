// SPDX-License-Identifier: Apache-2.0
// An inverse larger than the largest buffer of the device (lavapipe: 128 MiB; where it takes larger
// ones, than a limit set here), and as a soak test one over 2 GiB: products and updates go over
// several buffers.
#include <numeric>

#include "gpu/passes/dense_inverse.hpp"
#include "gpu/passes/fields.hpp"
#include "kernels_fixture.hpp"

namespace sunder::test {
namespace {

#ifdef SUNDER_SOAK
constexpr Index kCells = 62;  // 23,436 unknowns: 2.2 GB
#else
constexpr Index kCells = 31;  // 5,952 unknowns: 146 MB
#endif

/// Symmetric, at most 1 in modulus, exact in fp32.
double entry(Index i, Index j) {
  return static_cast<double>((7 * (i + j) + i % 64 * (j % 64)) % 97 - 48) / 64;
}

/// One value in 61 of a vector carries something: the host's product stays cheap.
double value(Index i) { return i % 61 == 0 ? static_cast<double>(i % 5 - 2) : 0.0; }

using LargeInverse = Kernels;

TEST_P(LargeInverse, TakesSeveralBuffers) {
  Scene scene;
  scene.mesh = structured_board({kCells, kCells, 1, 50, 50, 2.5});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 49.99, -1), Vec3(51, 50.01, 4)}, Axes{7}});
  const Problem problem(scene);
  const Index n = problem.dof_count();
  gpu::Fields fields(*factory_, problem, {});
  const auto planned = [&](std::size_t panel_bytes) {
    return gpu::DenseInverse::planned(*factory_, n, fields.rows(), panel_bytes);
  };
  const std::size_t panel_bytes = planned(0).panels > 1 ? 0 : planned(0).bytes / 2;
  ASSERT_GT(planned(panel_bytes).panels, 1u);
  gpu::DenseInverse inverse(*factory_, n, fields.rows(), panel_bytes);
#ifdef SUNDER_SOAK
  ASSERT_GT(inverse.bytes(), std::size_t{1} << 31);
#endif
  inverse.upload([&](Index first, Index count) {
    return Eigen::MatrixXd::NullaryExpr(n, count,
                                        [first](Index i, Index j) { return entry(i, first + j); });
  });
  gpu::PartialSums partials(*factory_, fields.rows(), inverse.chunks());
  inverse.bind(partials, fields.residual());
  const auto sum = partials.bind_sum(fields.positions(), fields.nodal(gpu::Field::displacement));
  std::vector<double> r(fields.rows(), 0.0);
  for (Index i = 0; i < n; ++i) r[static_cast<std::size_t>(i)] = value(i);
  fields.write_residual(r);

  // X += z z^T with z = X(:, d) / 8, d in the last buffer.
  const Index d = n - 1;
  inverse.update({&d, 1}, Eigen::MatrixXd::Constant(1, 1, 0.125));
  vulkan::Commands commands(*device_);
  commands.begin();
  const std::uint32_t chunks = inverse.record_dense(commands, 0);
  partials.record_sum(commands, *sum, chunks, false);
  commands.end();
  commands.submit();

  std::vector<Index> rows;
  for (Index i = 0; i < n; i += 997) rows.push_back(i);
  const Eigen::VectorXd product = fields.read_unknowns(gpu::Field::displacement, rows);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Index i = rows[k];
    double expected = 0, size = 0;
    for (Index j = 0; j < n; j += 61) {
      const double x = entry(i, j) + entry(i, d) * entry(d, j) / 64;
      expected += x * value(j);
      size += std::abs(x * value(j));
    }
    // X rounded once by the update; of a chunk's 64 products two are not zero.
    EXPECT_NEAR(product[static_cast<Index>(k)], expected, 4 * GetParam().eps() * size) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(All, LargeInverse, testing::Values(Numbers{gpu::Variant::lvp, false}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
