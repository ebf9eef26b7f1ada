// SPDX-License-Identifier: Apache-2.0
// K of split cracks against published solutions, in plane strain (u_z = 0 on both faces).
#include "core/field_sif/published.hpp"
#include "measured_split.hpp"

namespace sunder {
namespace {

struct Strip {
  Index layers = 1;
  double poisson = 0.3, shaken = 0;
};

constexpr Index kAcross = 40, kHigh = 100;  // elements across, three widths high
constexpr double kWidth = 40, kHeight = 100;

Scene strip_scene(const Strip& of) {
  std::mt19937 random(11);
  const double depth = static_cast<double>(of.layers);
  Scene scene = test::plane_strain_plate(
      test::shaken_board({kAcross, kHigh, of.layers, kWidth, kHeight, depth}, random, of.shaken),
      of.poisson);
  // Balanced loads leave these without a reaction.
  const auto at = [&](double y) {  // shaken nodes move along the side
    return Box{Vec3(kWidth - 1e-9, y - 0.3, -test::kFar), Vec3(test::kFar, y + 0.3, test::kFar)};
  };
  scene.supports.push_back({at(kHeight / 2), Axes{3}});
  scene.supports.push_back({at(kHeight), Axes{1}});
  return scene;
}

double published(double a) { return test::tada_edge(a / kWidth) * std::sqrt(EIGEN_PI * a); }

/// An edge crack in tension, 1 MPa on both ends, split through the mesh step by step.
class Tension {
 public:
  explicit Tension(const Strip& of) : plate_(strip_scene(of)) {
    plate_.load(test::traction_of(
        plate_.problem().mesh(),
        [](const Vec3& x) { return x.y() < 1e-9 || x.y() > kHeight - 1e-9; },
        [](const Vec3&) { return Mat3(Vec3(0, 1, 0).asDiagonal()); }));
    plate_.follow(plate_.crack().begin(0));
  }
  void grow_to(double length) {
    while (plate_.crack().tip().x() < length) plate_.follow(plate_.crack().advance(0));
  }
  /// K where the crack ends for its field, how long it is there, and half the work of the load.
  struct Found {
    double length = 0;
    fracture::IntensityFactors k;
    double energy = 0;
  };
  [[nodiscard]] Found measure() {
    const auto found = plate_.measure();
    return {found.tip.x(), found.k, plate_.energy()};
  }

 private:
  test::MeasuredSplit plate_;
};

class SplitIntensity : public ::testing::TestWithParam<Strip> {};

INSTANTIATE_TEST_SUITE_P(Plates, SplitIntensity,
                         ::testing::Values(Strip{1, 0.3, 0}, Strip{1, 0.3, 0.2}, Strip{2, 0.3, 0.2},
                                           Strip{3, 0.3, 0.2}, Strip{1, 0.45, 0.2},
                                           Strip{2, 0.45, 0}, Strip{3, 0.45, 0.2}),
                         [](const ::testing::TestParamInfo<Strip>& of) {
                           return std::to_string(of.param.layers) + "LayersNu" +
                                  std::to_string(static_cast<int>(100 * of.param.poisson)) +
                                  (of.param.shaken > 0 ? "Shaken" : "");
                         });

TEST_P(SplitIntensity, IsThatOfAnEdgeCrackWithinOnePercent) {
  Tension plate(GetParam());
  for (const double length : {8.0, 12.0, 16.0}) {  // .2 to .42 of the width; 1.3 % at .46
    plate.grow_to(length);
    const auto [a, k, energy] = plate.measure();
    EXPECT_NEAR(k.k_1, published(a), 0.01 * published(a)) << a;
    EXPECT_NEAR(k.k_2, 0, 0.04 * published(a)) << a;
  }
}

/// What a growing crack releases under a constant load, half the work that the load does by it, is
/// K^2 (1 - nu^2)/E times the area that opens.
TEST(SplitEnergy, IsReleasedAsKSays) {
  const Strip of{2, 0.3, 0};
  Tension plate(of);
  plate.grow_to(10);
  auto before = plate.measure();
  double released = 0;
  const double energy_before = before.energy;
  while (before.length < 15) {
    plate.grow_to(before.length + 1.5);
    const auto now = plate.measure();
    const auto g = [](const auto& found) { return 0.91 * found.k.k_1 * found.k.k_1; };
    released += (g(before) + g(now)) / 2 * (now.length - before.length) * 2;  // 2 mm thick, E = 1
    before = now;
  }
  EXPECT_NEAR(before.energy - energy_before, released, 0.02 * released);
}

}  // namespace
}  // namespace sunder
