// SPDX-License-Identifier: Apache-2.0
// The inverse computed on the device, against the CPU's.
#include <numeric>

#include "fem/assembly.hpp"
#include "fem/factor.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "gpu_body.hpp"
#include "sunder/error.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using Inversion = WithVulkan<>;

struct OnDevice {
  explicit OnDevice(gpu::Variant variant, bool fp64) {
    vulkan::InstanceOptions options;
    options.validation = true;
    const auto instance = std::make_shared<vulkan::Instance>(options);
    device = watched_device(instance, watched_probe());
    factory = std::make_unique<gpu::KernelFactory>(*device, variant, fp64);
  }
  Eigen::MatrixXd invert(const fem::SparseMatrix& lower, std::size_t panel_bytes) {
    const auto n = static_cast<Index>(lower.rows());
    const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
    gpu::DenseInverse inverse(*factory, n, rows, panel_bytes);
    gpu::invert_on_device(*factory, lower, rows, panel_bytes, inverse);
    std::vector<Index> all(static_cast<std::size_t>(n));
    std::iota(all.begin(), all.end(), 0);
    return inverse.pick(all, all);
  }
  std::unique_ptr<vulkan::Device> device;
  std::unique_ptr<gpu::KernelFactory> factory;
};

/// Some 300 unknowns, no multiple of 60 or 64, with a stiff frame.
fem::SparseMatrix small_stiffness() {
  Scene scene;
  scene.mesh = structured_board({8, 5, 1});
  scene.materials["board"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 3)}, Axes{7}});
  const Problem problem(scene);
  return fem::assemble_lower(problem, {});
}

TEST_F(Inversion, AgreesWithTheFactorsInverse) {
  const fem::SparseMatrix lower = small_stiffness();
  ASSERT_NE(lower.rows() % 60, 0);
  const Eigen::MatrixXd reference = fem::Factor(lower).inverse();
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
  fem::SparseMatrix lower = small_stiffness();
  lower.coeffRef(100, 100) = -1;
  OnDevice device(gpu::Variant::lvp, true);
  EXPECT_THROW(static_cast<void>(device.invert(lower, 0)), NumericalError);
}

TEST_F(Inversion, CarriesTheBoardThroughACrack) {
  Scene scene = held_board();
  Scene on_cpu = scene;
  on_cpu.solver.backend = "cpu";
  scene.solver.backend = "vulkan";
  scene.solver.precision = Precision::fp64;
  scene.solver.route = Route::inverse;
  const auto problem = std::make_shared<const Problem>(scene);
  Needs needs;
  needs.stress = needs.yield = needs.damage = true;
  const auto reference = cpu_reference::create(std::make_shared<const Problem>(on_cpu), needs);
  gpu::VulkanOptions options;
  options.invert_on_device = true;
  const auto backend = gpu::create(problem, needs, options);
  const auto compare = [&](double allowed) {
    for (Backend* b : {reference.get(), backend.get()}) {
      b->set_load(corner_pull(b->problem()));
      b->solve();
      b->stress();
    }
    EXPECT_LE(displacement_error(problem->mesh(), backend->destroyed(),
                                 Pair::displacement(*backend), Pair::displacement(*reference)),
              allowed);
    EXPECT_LE(stress_error(backend->destroyed(), Pair::stress(*backend), Pair::stress(*reference)),
              allowed);
  };
  compare(kIntactTolerance);
  const auto crack = crack_sequence(*problem, 20, 10);
  reference->destroy(crack);
  backend->destroy(crack);
  compare(kCrackTolerance);
}

}  // namespace
}  // namespace sunder::test
