// SPDX-License-Identifier: Apache-2.0
// K p by the blocked matrix of route cg, intact and with destroyed elements patched in place,
// against the assembled stiffness.
#include <algorithm>
#include <array>
#include <random>

#include "fem/assembly.hpp"
#include "gpu/cg_route.hpp"
#include "gpu/passes/block_matrix.hpp"
#include "gpu/passes/fields.hpp"
#include "gpu_body.hpp"
#include "kernels_fixture.hpp"

namespace sunder::test {
namespace {

/// cg_multiply with vectors of its own: four values a node.
class Multiply {
 public:
  Multiply(vulkan::Device& device, const gpu::KernelFactory& kernels, const gpu::Fields& fields,
           const gpu::BlockMatrix& matrix)
      : groups_(matrix.groups()), parts_(groups_ * kernels.parts()), commands_(device) {
    const std::size_t bytes = std::size_t{groups_} * shaders::kGroup * 4 * sizeof(double);
    p_ = vulkan::Buffer(device, bytes, vulkan::Placement::device);
    q_ = vulkan::Buffer(device, bytes, vulkan::Placement::device);
    sums_ = vulkan::Buffer(device, parts_ * sizeof(double), vulkan::Placement::device);
    using enum gpu::Reads;
    kernel_ = kernels.make("cg_multiply", {doubles, plain, words, doubles, plain, plain}, 0);
    const vulkan::Buffer* buffers[] = {
        &matrix.blocks(), &matrix.slices(), &fields.dofs(), &p_, &q_, &sums_};
    binding_ = std::make_unique<vulkan::Binding>(device, *kernel_, buffers);
  }

  struct Result {
    std::vector<double> q;  // four values a node
    double pq = 0;
  };
  Result operator()(std::span<const double> p) {
    p_.write(p);
    commands_.begin();
    commands_.dispatch(*binding_, groups_);
    commands_.end();
    return result(p.size());
  }
  /// What q holds after a dispatch of a size from a buffer; it held ones before.
  std::vector<double> of_size(const vulkan::Buffer& sizes, std::size_t offset) {
    const std::vector<double> ones(q_.bytes() / sizeof(double), 1.0);
    q_.write(std::span<const double>(ones));
    p_.fill_zero();
    commands_.begin();
    commands_.dispatch_indirect(*binding_, sizes, offset);
    commands_.end();
    return result(ones.size()).q;
  }

 private:
  Result result(std::size_t values) {
    commands_.submit();
    Result result{std::vector<double>(values), 0};
    q_.read(std::span<double>(result.q));
    std::vector<double> sums(parts_);
    sums_.read(std::span<double>(sums));
    for (double s : sums) result.pq += s;
    return result;
  }

  std::uint32_t groups_, parts_;
  vulkan::Buffer p_, q_, sums_;
  std::unique_ptr<vulkan::Kernel> kernel_;
  std::unique_ptr<vulkan::Binding> binding_;
  vulkan::Commands commands_;
};

class CgKernels : public Kernels {};

TEST_P(CgKernels, MultiplyByTheDamagedStiffness) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 3});
  for (Vec3& x : scene.mesh.nodes) x += 0.1 * Vec3(random(), random(), random());
  scene.materials["board"] = {5, 0.49, 2.0};
  // Nodes held along some axes only, too.
  scene.supports.push_back({Box{Vec3(-1, 9.5, -1), Vec3(11, 11, 2)}, Axes{5}});
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(11, 0.5, 2)}, Axes{2}});
  const Problem problem(scene);
  const gpu::Fields fields(*factory_, problem, all_needs());
  gpu::BlockMatrix matrix(*factory_, problem);
  Multiply multiply(*device_, *factory_, fields, matrix);
  std::vector<double> scale(problem.mesh().tets.size(), 1.0);
  const std::vector<Index> gone = {0, 17, 18, 19, 300, 629};
  for (const bool damaged : {false, true}) {
    if (damaged) {
      matrix.destroy(gone);
      for (Index e : gone) scale[static_cast<std::size_t>(e)] = problem.scene().fracture.alpha;
    }
    const auto padded = std::size_t{matrix.groups()} * shaders::kGroup * 4;
    std::vector<double> p(padded, 0.0);
    Eigen::VectorXd x(problem.dof_count());
    for (Index n = 0; n < problem.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        if (d != kNone) p[static_cast<std::size_t>(4 * n + axis)] = x[d] = uniform_(generator_);
      }
    }
    const auto [q, pq] = multiply(p);
    const fem::SparseMatrix k = fem::assemble_lower(problem, scale);
    const Eigen::MatrixXd full = Eigen::MatrixXd(k).selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd expected = full * x;
    // A row sums three products for each of some 30 neighbours, each entry 24 elements or fewer.
    const Eigen::VectorXd size = full.cwiseAbs() * x.cwiseAbs();
    const double units = 3 * 30 + 24 + 16;
    for (Index n = 0; n < problem.node_count(); ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        const Index d = problem.dof(n, axis);
        const double value = q[static_cast<std::size_t>(4 * n + axis)];
        if (d == kNone) {
          EXPECT_EQ(value, 0) << "held axis of node " << n;
        } else {
          EXPECT_TRUE(std::abs(value - expected[d]) <= units * kEps64 * size[d])
              << "node " << n << ": " << value << " against " << expected[d];
        }
      }
    }
    EXPECT_NEAR(pq, x.dot(expected),
                (units + static_cast<double>(x.size())) * kEps64 * x.cwiseAbs().dot(size));
  }
}

/// The iterations recorded beyond the last one that is needed do nothing.
TEST_P(CgKernels, DispatchesBeyondConvergenceAreEmpty) {
  Scene scene;
  scene.mesh = structured_board({7, 5, 1});
  scene.materials["board"] = {5, 0.4, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 2)}, Axes{7}});
  const Problem problem(scene);
  gpu::Fields fields(*factory_, problem, all_needs(), {0, true});
  gpu::CgRoute route(*factory_, problem, fields);
  std::vector<double> force(fields.rows(), 0.0);
  const Load load{{0}, {1e-3}, {}};
  force[0] = load.forces.front();
  fields.set_load(force, {});
  const int iterations = route.solve(load, true);
  EXPECT_GT(iterations, 0);
  EXPECT_NE(iterations % 64, 0) << "the recorded iterations were all needed";

  std::array<std::uint32_t, 3 * shaders::kCgSizes> sizes{};
  route.dispatch_sizes().read(std::span<std::uint32_t>(sizes));
  Multiply multiply(*device_, *factory_, fields, fields.matrix());
  for (std::size_t kind = 0; kind < shaders::kCgSizes; ++kind) {
    EXPECT_EQ(sizes[3 * kind], 0u) << "kind " << kind;
    const auto q = multiply.of_size(route.dispatch_sizes(), 12 * kind);
    EXPECT_EQ(std::count(q.begin(), q.end(), 1.0), std::ssize(q)) << "kind " << kind;
  }
  // The same kernel by a size that is not zero.
  vulkan::Buffer one(*device_, 12, vulkan::Placement::host);
  std::fill_n(one.mapped<std::uint32_t>(), 3, 1u);
  const auto q = multiply.of_size(one, 0);
  EXPECT_EQ(std::count(q.begin(), q.end(), 0.0), 4 * shaders::kGroup);
}

INSTANTIATE_TEST_SUITE_P(All, CgKernels,
                         testing::Values(Numbers{gpu::Variant::gpu, true},
                                         Numbers{gpu::Variant::lvp, true}),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace sunder::test
