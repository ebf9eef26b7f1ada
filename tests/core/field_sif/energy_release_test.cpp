// SPDX-License-Identifier: Apache-2.0
// J at finite strain against a strip whose J is known, and against K where strains are small.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "cpu_reference/cpu_reference.hpp"
#include "material/law.hpp"
#include "material/linear.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/scene_keys.hpp"
#include "sunder/simulation.hpp"
#include "support/structured_board.hpp"

namespace sunder::test {
namespace {

constexpr double kYoung = 1, kPoisson = 0.4, kHeight = 12.5;

const Law& law_of(MaterialLaw law) { return *laws()[static_cast<std::size_t>(law)]; }

/// Energy per undeformed volume of a thin sheet that is held along x and stretched along y.
double sheet_energy(MaterialLaw law, double stretch) {
  const SmallStrain constants = small_strain({kYoung, kPoisson, {}, law});
  const auto at = [&](double thickness) {
    return law_of(law).energy(constants, Vec3(1, stretch, thickness).asDiagonal());
  };
  double low = 0.3, high = 1.2;
  for (int i = 0; i < 200; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
  }
  return at((low + high) / 2);
}

/// A strip of 48 x 12.5 mm, thin, held along both long edges, its upper one moved up; a crack of
/// one row of elements goes from the left to `tip`. `rows` of cells over its height, odd.
Scene strip(MaterialLaw law, double stretch, double tip, Index rows) {
  Scene scene;
  scene.mesh = structured_board({(96 * rows + 12) / 25, rows, 1, 48, kHeight, 0.5});
  scene.materials["board"] = {kYoung, kPoisson, {}, law};
  const double low = kHeight - 1e-6;
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(49, 1e-6, 1)}, Axes{3}});
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(49, 1e-6, 1e-6)}, Axes{4}});
  scene.supports.push_back({Box{Vec3(-1, low, -1), Vec3(49, 17, 1e-6)}, Axes{4}});
  Instrument grip;
  grip.name = "grip";
  grip.action =
      Grip{Box{Vec3(-1, low, -1), Vec3(49, 17, 1)}, Vec3(0, (stretch - 1) * kHeight, 0), Axes{3}};
  grip.ramp = Ramp{0, 1};
  scene.instruments.push_back(grip);
  PresetCrack crack;
  const double half = kHeight / rows / 2;
  crack.elements = Box{Vec3(-1, kHeight / 2 - half, -1), Vec3(tip, kHeight / 2 + half, 1)};
  crack.mouth = Vec3(0, kHeight / 2, 0.25);
  crack.tips = {Vec3(tip, kHeight / 2, 0.25)};
  scene.cracks.push_back(crack);
  scene.fracture.sif = SifSource::field;
  scene.steps = 2;
  return scene;
}

std::unique_ptr<Simulation> at_end(Scene scene) {
  const auto problem = std::make_shared<const Problem>(std::move(scene));
  auto simulation =
      std::make_unique<Simulation>(problem, cpu_reference::create(problem, needs_of(*problem)));
  while (!simulation->done()) simulation->step();
  return simulation;
}

TipState stretched(MaterialLaw law, double stretch, double tip, Index rows = 25) {
  const auto simulation = at_end(strip(law, stretch, tip, rows));
  EXPECT_EQ(simulation->tips().size(), 1U);
  return simulation->tips().front();
}

// finite.md: J = h0 min over l3 of W(1, l, l3), whatever the crack's length.
TEST(EnergyRelease, OfALongStripIsThatOfItsSheet) {
  for (const MaterialLaw law : {MaterialLaw::neo_hookean, MaterialLaw::corotated}) {
    for (const double stretch : {1.02, 1.3}) {
      const double expected = kHeight * sheet_energy(law, stretch);
      // At small strain the last tenth of a percent takes a finer mesh.
      const TipState at = stretched(law, stretch, 24, stretch > 1.1 ? 25 : 37);
      ASSERT_TRUE(at.j);
      std::printf("%s at stretch %.2f: J %.5f N/mm, of the sheet %.5f (%+.2f %%)\n",
                  law_of(law).name.data(), stretch, *at.j, expected, 100 * (*at.j / expected - 1));
      EXPECT_NEAR(*at.j, expected, 0.01 * expected);
      EXPECT_EQ(at.field_note == "strain", stretch > 1.1) << at.field_note;
      EXPECT_EQ(at.k_1.has_value(), stretch < 1.1);
      // Eq. 1 takes sqrt(J E'): of a thin sheet E.
      ASSERT_TRUE(at.k);
      EXPECT_NEAR(*at.k, std::sqrt(*at.j * kYoung), stretch > 1.1 ? 1e-12 : 0.03 * *at.k);
    }
  }
}

// A crack that grows where K of small strain has no meaning goes by J: K = sqrt(J E') with the E' =
// E of a thin sheet, and Eq. 1's reach by that K.
TEST(EnergyRelease, GrowthAtFiniteStrainGoesByIt) {
  constexpr double kYield = 0.3;
  Scene scene = strip(MaterialLaw::neo_hookean, 1.3, 24, 25);
  scene.materials["board"].yield = kYield;
  scene.fracture.model = FractureModel::b;
  scene.fracture.max_events = 3;
  const auto simulation = at_end(scene);
  int grown = 0;
  for (const DestroyedElement& d : simulation->destroyed()) {
    if (d.cause != Cause::sif) continue;
    ASSERT_TRUE(d.sif);
    if (d.sif->field_note.find("strain") == std::string_view::npos) continue;
    ++grown;
    EXPECT_FALSE(d.sif->k_1 || d.sif->k_2 || d.sif->k_3);
    ASSERT_TRUE(d.sif->j && d.sif->k_field);
    EXPECT_GT(*d.sif->j, 0);
    EXPECT_NEAR(d.sif->k, std::sqrt(*d.sif->j * kYoung), 1e-12 * d.sif->k);
    EXPECT_EQ(d.sif->k, *d.sif->k_field);
    const double half = std::abs(d.sif->theta) * std::numbers::pi / 360;
    const double shape = std::cos(half) * (1 + std::sin(half));
    const double reach =
        d.sif->k * d.sif->k / (2 * std::numbers::pi * kYield * kYield) * shape * shape;
    EXPECT_NEAR(d.sif->reach, reach, 1e-12 * reach);
    EXPECT_GE(*d.ratio, 1);
  }
  EXPECT_GT(grown, 0) << simulation->destroyed().size() << " destroyed";
}

/// The patches' J is that of the elements where these do not lock, and the sheet's at nu .49.
TEST(EnergyRelease, OfPooledVolumeIsThatOfTheSheetToo) {
  for (const double stretch : {1.02, 1.3}) {
    Scene scene = strip(MaterialLaw::neo_hookean, stretch, 24, stretch > 1.1 ? 25 : 37);
    scene.materials["board"].volume = MaterialVolume::pooled;
    const auto simulation = at_end(scene);
    const TipState at = simulation->tips().front();
    ASSERT_TRUE(at.j);
    const double expected = kHeight * sheet_energy(MaterialLaw::neo_hookean, stretch);
    std::printf("pooled at stretch %.2f: J %.5f N/mm, of the sheet %.5f (%+.2f %%)\n", stretch,
                *at.j, expected, 100 * (*at.j / expected - 1));
    EXPECT_NEAR(*at.j, expected, 0.01 * expected);
  }
}

TEST(EnergyRelease, DoesNotDependOnTheCracksLength) {
  const double one = *stretched(MaterialLaw::neo_hookean, 1.3, 20).j,
               other = *stretched(MaterialLaw::neo_hookean, 1.3, 28).j;
  EXPECT_NEAR(one, other, 5e-3 * one);
}

}  // namespace
}  // namespace sunder::test
