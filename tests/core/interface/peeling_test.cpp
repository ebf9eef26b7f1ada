// SPDX-License-Identifier: Apache-2.0
// A strip that is peeled off its bed: the force is that of the energy, on any mesh, at any
// strength.
#include <gtest/gtest.h>

#include <cmath>

#include "bonded_blocks.hpp"
#include "cpu_reference/cpu_reference.hpp"
#include "sunder/simulation.hpp"

namespace sunder::test {
namespace {

constexpr double kBed = 0.25, kThick = 0.25, kLong = 20, kFree = 2;  // [mm]

/// A strip on a bed, its first kFree mm not bonded; `rows` cells of kWidth across.
Scene strip(Index cells, Index rows, double strength) {
  const BoardShape shape{cells, rows, 2, kLong, 0.25 * rows, kBed + kThick};
  Scene scene = body_of(
      shape, [](const Vec3& x) { return x.z() < kBed ? "bed" : "strip"; }, tissue(5));
  scene.interfaces.push_back({{"bed", "strip"}, strength, kEnergy, 1});
  scene.supports.push_back({slab(2, -1, 0.99 * kBed), Axes{}});
  Box free{Vec3(-1, -1, kBed - 1e-9), Vec3(kFree, 99, kBed + 0.011)};
  scene.removals.push_back({0, free});
  scene.fracture.model = FractureModel::a;
  return scene;
}

// Upright: the strip's end is lifted and free to follow, F/w = G_c (Rivlin 1944).
struct Peeled {
  double force = 0;   ///< mean over the steady part, per width and energy
  double energy = 0;  ///< of the rows over G_c times the area
};
Peeled peel(Index cells, Index rows, double strength, int steps = 140) {
  Scene scene = strip(cells, rows, strength);
  constexpr double kLift = 14, kSteady = 8;
  Box end{Vec3(-1, -1, kBed + 0.02), Vec3(1e-6, 99, 9)};
  scene.instruments.push_back({"grip", Grip{end, Vec3(0, 0, kLift), Axes{4}}, Ramp{0, 1}});
  scene.steps = steps;
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  Simulation simulation(problem, cpu_reference::create(problem, needs_of(*problem)));
  double sum = 0;
  int count = 0;
  while (!simulation.done()) {
    simulation.step();
    if (kLift * simulation.steps_done() / problem->scene().steps < kSteady) continue;
    sum += simulation.reactions()[0].z();
    ++count;
  }
  double energy = 0, area = 0;
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (row.cause != Cause::parting) continue;
    energy += *row.energy;
    area += problem->interfaces()->area(row.element);
  }
  const double width = 0.25 * rows;
  EXPECT_GT(area, 8 * width) << "the strip comes off";
  EXPECT_LT(area, (kLong - kFree - 2) * width) << "and not all of it";
  return {sum / count / width / kEnergy, energy / area / kEnergy};
}

TEST(Peeling, UprightTheForceIsTheEnergyOnAnyMesh) {
  for (const Index cells : {60, 80, 120}) {
    const Peeled found = peel(cells, 1, kStrength);
    std::printf("%d cells: F/(w G) %.4f, energy %.4f\n", cells, found.force, found.energy);
    EXPECT_NEAR(found.force, 1, 0.05) << cells;
    EXPECT_NEAR(found.energy, 1, 0.02) << cells;
  }
}

TEST(Peeling, OfAnyStrength) {
  for (const double strength : {0.05, 0.12}) {
    const Peeled found = peel(60, 1, strength);
    std::printf("strength %.2f: F/(w G) %.4f, energy %.4f\n", strength, found.force, found.energy);
    EXPECT_NEAR(found.force, 1, 0.05) << strength;
    EXPECT_NEAR(found.energy, 1, 0.02) << strength;
  }
}

// By steps in which the edge moves on by a cell or more, so that rows part one after the other in
// one step. The force at the end of each, after that, is below the mean of the saw teeth that many
// steps show; it was 1.5 times G_c where later rows did not expect what the first one releases.
TEST(Peeling, ByLargeSteps) {
  for (const int steps : {42, 28}) {
    const Peeled found = peel(60, 1, kStrength, steps);
    std::printf("%d steps: F/(w G) %.4f, energy %.4f\n", steps, found.force, found.energy);
    EXPECT_LT(found.force, 1.05) << steps;
    EXPECT_GT(found.force, 0.75) << steps;
    EXPECT_NEAR(found.energy, 1, 0.02) << steps;
  }
}

// With several nodes across the front, where the first of a row to part takes the others along.
TEST(Peeling, OfAnyWidth) {
  const Peeled found = peel(60, 3, kStrength);
  std::printf("F/(w G) %.4f, energy %.4f\n", found.force, found.energy);
  EXPECT_NEAR(found.force, 1, 0.05);
  EXPECT_NEAR(found.energy, 1, 0.02);
}

}  // namespace
}  // namespace sunder::test
