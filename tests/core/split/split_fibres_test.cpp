// SPDX-License-Identifier: Apache-2.0
// Cracks in a tissue with fibres: they turn by the angle that G(theta)/G_c(theta) says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
constexpr double kPlateWidth = 32, kPlateHeight = 31, kNotch = 10;

/// A plate between held ends that are moved apart, with a notch of one row of elements from the
/// left edge; fibres at an angle to it, which take `ratio` times as much energy to cut across.
struct PlateOf {
  double fibres = 0;  // degrees
  double ratio = 1;
  CrackWay crack = CrackWay::split;
  MaterialLaw law = MaterialLaw::linear;

  [[nodiscard]] Scene scene() const {
    Scene scene;
    scene.mesh = test::structured_board({32, 31, 1, kPlateWidth, kPlateHeight, 1});
    Material tissue{5, 0.3, {}};
    tissue.law = law;
    tissue.energy = 0.02;
    Fibres family;
    family.direction = Vec3(std::cos(fibres * kOneDegree), std::sin(fibres * kOneDegree), 0);
    family.energy_across = ratio * *tissue.energy;
    tissue.fibres = {family};
    scene.materials["board"] = tissue;
    scene.supports.push_back({Box{{-1, -0.1, -1}, {99, 0.1, 2}}, Axes{7}});
    Instrument grip{"grip",
                    Grip{Box{{-1, kPlateHeight - 0.1, -1}, {99, kPlateHeight + 0.1, 2}},
                         Vec3(0, 2, 0), Axes{7}},
                    {}};
    grip.ramp = Ramp{0, 1};
    scene.instruments = {grip};
    PresetCrack notch;
    notch.elements = Box{{-1, 15, -1}, {kNotch, 16, 2}};
    notch.mouth = Vec3(0, 15.5, 0.5);
    notch.tips = {Vec3(kNotch, 15.5, 0.5)};
    scene.cracks = {notch};
    scene.fracture.model = FractureModel::b;
    scene.fracture.sif = SifSource::field;
    scene.fracture.crack = crack;
    scene.fracture.plane_normal = Vec3(0, 0, 1);
    scene.steps = 40;
    return scene;
  }
};

struct FibrousPlate {
  explicit FibrousPlate(const PlateOf& plate) : FibrousPlate(plate.scene()) {}
  explicit FibrousPlate(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  /// Until the crack has grown so far.
  void grow(double length) {
    do {
      simulation.step();
    } while (!simulation.done() && simulation.cracks()[0].length < kNotch + length);
  }
  [[nodiscard]] std::optional<SifTerms> first() const {
    for (const DestroyedElement& row : simulation.destroyed()) {
      if (row.cause == Cause::sif) return row.sif;
    }
    return {};
  }
  std::shared_ptr<const Problem> problem;
  Simulation simulation;
};

/// Where the energy of a turn over what it takes is largest [deg], by Nuismer's G(theta).
double by_energy(double k_1, double k_2, double fibres, double ratio) {
  double best = 0, at = 0;
  for (double degrees = -80; degrees <= 80; degrees += 0.02) {
    const double theta = degrees * kOneDegree, half = std::cos(theta / 2) / 2;
    const double c = std::cos(theta), s = std::sin(theta);
    const double opening = half * (k_1 * (1 + c) - 3 * k_2 * s);
    const double sliding = half * (k_1 * s + k_2 * (3 * c - 1));
    const double across = std::sin((degrees - fibres) * kOneDegree);
    const double g = (opening * opening + sliding * sliding) / (1 + (ratio - 1) * across * across);
    if (opening > 0 && g > best) {
      best = g;
      at = degrees;
    }
  }
  return at;
}

/// Chord of what has opened of the crack, from the notch [deg].
double way_of(const FibrousPlate& plate) {
  const Crack& crack = plate.simulation.cracks()[0];
  const Vec2 way = crack.tips[0].position - Vec2(kNotch, 15.5);
  return std::atan2(way.y(), way.x()) / kOneDegree;
}

TEST(SplitFibres, TurnACrackByTheAngleThatEnergyOverToughnessSays) {
  for (const double fibres : {30.0, 60.0, -45.0}) {
    for (const double ratio : {2.0, 9.0}) {
      FibrousPlate plate({fibres, ratio});
      plate.grow(6);
      const auto row = plate.first();
      ASSERT_TRUE(row && row->k_1 && row->k_2) << fibres;
      EXPECT_NEAR(*row->k_2, 0, 0.01 * *row->k_1);
      const double expected = by_energy(*row->k_1, *row->k_2, fibres, ratio);
      EXPECT_NEAR(row->theta, expected, 0.5) << fibres;
      std::printf(
          "fibres at %.0f deg, %.0f times across: turns by %.2f deg for %.2f, opens at %.1f\n",
          fibres, ratio, row->theta, expected, way_of(plate));
      // It is weakly held back across, strongly led along.
      if (ratio > 4) {
        EXPECT_NEAR(way_of(plate), by_energy(1, 0, fibres, ratio), 3) << fibres;
      }
    }
  }
}

TEST(SplitFibres, OpenWhatLiesAlongTheWay) {
  const double fibres = 60;
  FibrousPlate plate({fibres, 9});
  plate.grow(8);
  const Mesh mesh = plate.simulation.mesh();
  // Least squares through the opened nodes, a cell beyond the notch's own width.
  double sum = 0, xs = 0, ys = 0, xx = 0, xy = 0;
  for (const CrackFace& face : plate.simulation.crack_faces()) {
    for (const Index n : face.left) {
      const Vec3& at = mesh.nodes[static_cast<std::size_t>(n)];
      if (at.x() < kNotch + 0.5) continue;
      ++sum;
      xs += at.y();
      ys += at.x();
      xx += at.y() * at.y();
      xy += at.y() * at.x();
    }
  }
  ASSERT_GT(sum, 20);
  const double slope = (sum * xy - xs * ys) / (sum * xx - xs * xs);  // dx/dy, for it is steep
  EXPECT_NEAR(std::atan2(1, slope) / kOneDegree, way_of(plate), 4);
}

TEST(SplitFibres, JudgeByWhatTheDirectionTakes) {
  FibrousPlate plate({45, 4});
  plate.grow(1);
  const auto row = plate.first();
  ASSERT_TRUE(row && row->toughness);
  const double across = std::sin((row->theta - 45) * kOneDegree);
  // Plane stress: the ring does not see what dies off within half the thickness.
  const double energy = 0.02 * (1 + 3 * across * across);
  EXPECT_NEAR(*row->toughness, std::sqrt(5 * energy), 1e-9);
  EXPECT_GE(row->k, *row->toughness);
}

TEST(SplitFibres, TurnCracksOfDestroyedElementsAndOfOtherLawsToo) {
  for (const auto& [crack, law] : {std::pair(CrackWay::destroyed, MaterialLaw::linear),
                                   std::pair(CrackWay::split, MaterialLaw::neo_hookean)}) {
    FibrousPlate plate({45, 9, crack, law});
    plate.grow(5);
    const auto row = plate.first();
    ASSERT_TRUE(row);
    EXPECT_NEAR(row->theta, by_energy(1, 0, 45, 9), 3);
    EXPECT_NEAR(way_of(plate), by_energy(1, 0, 45, 9), 5);
  }
}

// Easier to cut than to part: the crack turns away from the fibres.
TEST(SplitFibres, AreCutWhereThatTakesLess) {
  FibrousPlate plate({70, 0.2});
  plate.grow(1);
  const auto row = plate.first();
  ASSERT_TRUE(row && row->k_1);
  const double expected = by_energy(*row->k_1, *row->k_2, 70, 0.2);
  EXPECT_LT(expected, -5);
  EXPECT_NEAR(row->theta, expected, 0.5);
}

// Through the thickness they are parted, whichever way the crack goes.
TEST(SplitFibres, AcrossTheBoardGuideNothing) {
  Scene scene = PlateOf{0, 9}.scene();
  scene.materials["board"].fibres[0].direction = Vec3(0, 0, 1);
  FibrousPlate plate(std::move(scene));
  plate.grow(3);
  const auto row = plate.first();
  ASSERT_TRUE(row && row->toughness);
  EXPECT_NEAR(row->theta, 0, 1);
  EXPECT_NEAR(*row->toughness, std::sqrt(5 * 0.02), 1e-9);
}

TEST(SplitFibres, OfAToughnessGuideAsThoseOfAnEnergy) {
  FibrousPlate by_energy({45, 4});
  Scene scene = PlateOf{45, 4}.scene();
  Material& tissue = scene.materials["board"];
  tissue.energy.reset();
  tissue.toughness = std::sqrt(5 * 0.02);
  tissue.fibres[0].energy_across.reset();
  tissue.fibres[0].toughness_across = 2 * *tissue.toughness;
  FibrousPlate by_toughness(std::move(scene));
  by_energy.grow(4);
  by_toughness.grow(4);
  ASSERT_TRUE(by_energy.first() && by_toughness.first());
  EXPECT_NEAR(by_energy.first()->theta, by_toughness.first()->theta, 1e-6);
  EXPECT_NEAR(*by_energy.first()->toughness, *by_toughness.first()->toughness, 1e-9);
}

}  // namespace
}  // namespace sunder
