// SPDX-License-Identifier: Apache-2.0
// The inverse computed on the device, against the CPU's.
#include <numeric>

#include "body/assembly.hpp"
#include "gpu/host_base.hpp"
#include "gpu/passes/block_inversion.hpp"
#include "gpu/passes/inverse_refinement.hpp"
#include "linear_algebra/factor.hpp"
#include "on_device.hpp"
#include "sunder/error.hpp"
#include "support/table1_board.hpp"

namespace sunder::test {
namespace {

using Inversion = WithVulkan<>;

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

/// A frame 1e6 times as stiff as what it holds.
linear_algebra::SparseMatrix stiff_and_soft() {
  Scene scene;
  scene.mesh = structured_board({8, 5, 1}, [](const Vec3& x) {
    return x.x() < 3 ? std::string("frame") : std::string("board");
  });
  scene.materials["board"] = {5, 0.45, 2.0};
  scene.materials["frame"] = {5e6, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 3)}, Axes{7}});
  const Problem problem(scene);
  return fem::assemble_lower(problem, {});
}

TEST_F(Inversion, LosesNoDigitsOfWhatIsSoft) {
  const linear_algebra::SparseMatrix lower = stiff_and_soft();
  const Eigen::MatrixXd reference = linear_algebra::Factor(lower).inverse();
  OnDevice device(gpu::Variant::lvp, true);
  const Eigen::MatrixXd inverse = device.invert(lower, 0);
  double worst = 0;
  for (Eigen::Index c = 0; c < inverse.cols(); ++c) {
    worst = std::max(worst, (inverse.col(c) - reference.col(c)).norm() / reference.col(c).norm());
  }
  EXPECT_LE(worst, 1e-11) << "with one scale for all 7.7e-8";
}

TEST_F(Inversion, AMatrixThatIsNotPositiveDefiniteIsRefused) {
  linear_algebra::SparseMatrix lower = small_stiffness();
  lower.coeffRef(100, 100) = -1;
  OnDevice device(gpu::Variant::lvp, true);
  EXPECT_THROW(static_cast<void>(device.invert(lower, 0)), NumericalError);
}

// Where nobody asks for a precision, stress is in fp32, and the inverse stays in fp64.
TEST_F(Inversion, StaysInFp64WhereThePrecisionIsOpen) {
  for (const Precision precision : {Precision::automatic, Precision::fp32}) {
    Pair pair(held_board(), {.precision = precision, .inverts = true});
    EXPECT_EQ(pair.vulkan->info().precision, "fp32");
    const bool kept = std::ranges::any_of(pair.vulkan->buffers(), [](const BufferPlan& b) {
      return b.name == "inverse (device, fp64)";
    });
    EXPECT_EQ(kept, precision == Precision::automatic);
    pair.load(corner_pull(pair.problem()));
    pair.destroy(crack_sequence(pair.problem(), 20, 10));
    EXPECT_LE(pair.solve().u, precision == Precision::automatic ? kCrackTolerance : kFp32Tolerance);
  }
}

TEST_F(Inversion, CarriesTheBoardThroughACrack) {
  Pair pair(held_board(), {.inverts = true});
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

// Frames 10,000 times as stiff as the tissue, and a grip, whose anchors are in the factor: columns
// of the factor and of the device's inverse are 7e-9 off, until refined by what elements sum.
TEST_F(Inversion, ColumnsOfStiffFramesAreRefined) {
  struct Case {
    double contrast;
    bool supported;
  };
  for (const auto& [contrast, supported] : {Case{1, true}, Case{1e4, true}, Case{1e4, false}}) {
    SCOPED_TRACE(std::to_string(contrast) + (supported ? ", supported" : ", held by a grip alone"));
    Scene scene = held_board();
    set_contrast(scene, contrast);
    scene.instruments.push_back(
        {"grip", Grip{Box{Vec3(-1, -1, -1), Vec3(60, 5, 9)}, Vec3(0, -1, 0), Axes{}}, Ramp{0, 1}});
    if (!supported) scene.supports.clear();
    const auto problem = std::make_shared<const Problem>(scene);
    const fem::DamagedBody body(problem);
    const auto n = problem->dof_count();
    const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
    OnDevice device(gpu::Variant::lvp, true);
    gpu::DenseInverse inverse(*device.factory, n, rows, 0);
    gpu::invert_on_device(*device.factory, body.stiffness(), rows, 0, inverse);
    const auto factor = std::make_shared<const gpu::HostInverse>(*problem, false);
    gpu::HostBase by_factor(factor, &body), by_device(factor, &body, &inverse), plain(factor);
    EXPECT_EQ(by_factor.refines(), contrast > 1);
    EXPECT_EQ(by_device.refines(), contrast > 1);
    const std::vector<Index> some{4, n / 2, n - 5};
    const Eigen::MatrixXd a = by_factor.unit_columns(some), b = by_device.unit_columns(some),
                          c = plain.unit_columns(some);
    EXPECT_LE((a - b).norm(), (contrast > 1 ? 1e-12 : 1e-10) * a.norm());
    EXPECT_LE((a - c).norm(), 1e-7 * a.norm());
  }
}

// Another matrix on the device than the host has tells whose columns are taken.
// The same once and for all, panel by panel: what its columns lacked is gone.
TEST_F(Inversion, IsRefinedBesideStiffFrames) {
  Scene scene = held_board();
  set_contrast(scene, 1e4);
  const auto problem = std::make_shared<const Problem>(scene);
  fem::DamagedBody body(problem);
  body.destroy(std::vector<Index>{700, 701, 702});
  const auto n = problem->dof_count();
  const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  const auto factor = std::make_shared<const gpu::HostInverse>(
      std::make_shared<const linear_algebra::Factor>(body.stiffness()), false,
      linear_algebra::FactorWork{});
  std::vector<Index> some;
  for (Index d = 0; d < n; d += 97) some.push_back(d);
  gpu::HostBase by_factor(factor, &body);
  ASSERT_TRUE(by_factor.refines());
  const Eigen::MatrixXd exact = by_factor.unit_columns(some);
  for (const gpu::Variant variant : {gpu::Variant::lvp, gpu::Variant::gpu}) {
    OnDevice device(variant, true);
    gpu::DenseInverse inverse(*device.factory, n, rows, std::size_t{rows} * 700 * 8);
    EXPECT_GT(inverse.parts().size(), 2u);
    gpu::invert_on_device(*device.factory, body.stiffness(), rows, std::size_t{rows} * 700 * 8,
                          inverse);
    const auto error = [&] {
      Eigen::MatrixXd columns(n, static_cast<Index>(some.size()));
      inverse.read_columns(some, columns);
      return (columns - exact).norm() / exact.norm();
    };
    EXPECT_GT(error(), 1e-10);
    gpu::refine_inverse(*device.factory, body, rows, inverse);
    EXPECT_LE(error(), 1e-13);
    const gpu::HostBase read(factor, &body, &inverse);
    EXPECT_FALSE(read.refines());
  }
}

TEST_F(Inversion, NewColumnsAreReadFromTheDevice) {
  const linear_algebra::SparseMatrix lower = small_stiffness(), doubled = 2 * lower;
  const Eigen::MatrixXd reference = linear_algebra::Factor(doubled).inverse();
  Scene scene;
  scene.mesh = structured_board({8, 5, 1});
  scene.materials["board"] = {5, 0.45, 2.0};
  scene.supports.push_back({Box{Vec3(-1, 9.9, -1), Vec3(11, 11, 3)}, Axes{7}});
  const Problem problem(scene);
  const auto n = static_cast<Index>(lower.rows());
  const auto rows = gpu::round_up(static_cast<std::uint32_t>(n), shaders::kRowPad);
  for (const std::size_t panel_bytes : {std::size_t{0}, std::size_t{64} * 512 * 8}) {
    OnDevice device(gpu::Variant::lvp, true);
    gpu::DenseInverse inverse(*device.factory, n, rows, panel_bytes);
    gpu::invert_on_device(*device.factory, doubled, rows, panel_bytes, inverse);
    gpu::HostBase base(std::make_shared<const gpu::HostInverse>(problem, false));
    base.read_from(&inverse);
    const std::vector<solver::Difference> vectors{{7, kNone}, {200, 9}, {n - 1, 7}};
    linear_algebra::RowMajor gram(8, 8);
    base.push(vectors, gram);
    Eigen::MatrixXd expected(n, 3);
    expected << reference.col(7), reference.col(200) - reference.col(9),
        reference.col(n - 1) - reference.col(7);
    const double scale = expected.cwiseAbs().maxCoeff();
    EXPECT_LE((base.columns().leftCols(3) - expected).cwiseAbs().maxCoeff(), 1e-11 * scale);
    EXPECT_NEAR(gram(2, 1), expected(n - 1, 1) - expected(7, 1), 1e-11 * scale);
    const Index unit = 64;
    EXPECT_LE((base.unit_columns({&unit, 1}) - reference.col(unit)).cwiseAbs().maxCoeff(),
              1e-11 * scale);
  }
}

}  // namespace
}  // namespace sunder::test
