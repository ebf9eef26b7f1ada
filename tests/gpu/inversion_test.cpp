// SPDX-License-Identifier: Apache-2.0
// The inverse computed on the device, against the CPU's.
#include <numeric>

#include "body/assembly.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "gpu_body.hpp"
#include "linear_algebra/factor.hpp"
#include "sunder/error.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using Inversion = WithVulkan<>;

struct OnDevice {
  OnDevice(gpu::Variant variant, bool fp64) {
    vulkan::InstanceOptions options;
    options.validation = validated();
    options.messages = messages;
    const auto instance = std::make_shared<vulkan::Instance>(options);
    device = watched_device(instance, watched_probe());
    factory = std::make_unique<gpu::KernelFactory>(*device, variant, fp64);
  }
  ~OnDevice() {
    factory.reset();
    device.reset();
    for (const std::string& m : messages->texts) ADD_FAILURE() << m;
  }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;
  Eigen::MatrixXd invert(const linear_algebra::SparseMatrix& lower, std::size_t panel_bytes) {
    const auto n = static_cast<Index>(lower.rows());
    const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
    gpu::DenseInverse inverse(*factory, n, rows, panel_bytes);
    gpu::invert_on_device(*factory, lower, rows, panel_bytes, inverse);
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    return inverse.pick(all, all);
  }
  std::shared_ptr<vulkan::Messages> messages = std::make_shared<vulkan::Messages>();
  std::unique_ptr<vulkan::Device> device;
  std::unique_ptr<gpu::KernelFactory> factory;
};

/// Some 300 unknowns, no multiple of 60 or 64, with a stiff frame.
linear_algebra::SparseMatrix small_stiffness() {
  Scene scene;
  scene.mesh = structured_board({8, 5, 1});
  scene.materials["board"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 3)}, Axes{7}});
  const Problem problem(scene);
  return fem::assemble_lower(problem, {});
}

TEST_F(Inversion, AgreesWithTheFactorsInverse) {
  const linear_algebra::SparseMatrix lower = small_stiffness();
  ASSERT_NE(lower.rows() % 60, 0);
  const Eigen::MatrixXd reference = linear_algebra::Factor(lower).inverse();
  for (const gpu::Variant variant : {gpu::Variant::gpu, gpu::Variant::lvp}) {
    for (const bool fp64 : {false, true}) {
      OnDevice device(variant, fp64);
      for (const std::size_t panel_bytes : {std::size_t{0}, std::size_t{64} * 512 * 8}) {
        const Eigen::MatrixXd inverse = device.invert(lower, panel_bytes);
        const double error = (inverse - reference).norm() / reference.norm();
        // Computed in fp64, rounded when stored.
        EXPECT_LE(error, fp64 ? 1e-12 : 6e-8) << (variant == gpu::Variant::gpu ? "gpu" : "lvp");
      }
    }
  }
}

TEST_F(Inversion, AMatrixThatIsNotPositiveDefiniteIsRefused) {
  linear_algebra::SparseMatrix lower = small_stiffness();
  lower.coeffRef(100, 100) = -1;
  OnDevice device(gpu::Variant::lvp, true);
  EXPECT_THROW(static_cast<void>(device.invert(lower, 0)), NumericalError);
}

TEST_F(Inversion, CarriesTheBoardThroughACrack) {
  Pair pair(held_board(), {}, all_needs(),
            [](gpu::VulkanOptions& options) { options.invert_on_device = true; });
  pair.load(corner_pull(pair.problem()));
  const auto compare = [&](double allowed) {
    const auto errors = pair.solve();
    EXPECT_LE(errors.u, allowed);
    EXPECT_LE(errors.stress, allowed);
  };
  compare(kIntactTolerance);
  pair.destroy(crack_sequence(pair.problem(), 20, 10));
  compare(kCrackTolerance);
}

}  // namespace
}  // namespace sunder::test
