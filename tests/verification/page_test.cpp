// SPDX-License-Identifier: Apache-2.0
// docs/verification.md holds what the run writes: the cheaper cells of each section computed again
// and compared digit by digit.
#include "verification/page.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "core/field_sif/published.hpp"
#include "verification/engine_cases.hpp"
#include "verification/peeling_cases.hpp"
#include "verification/pooled_cases.hpp"
#ifdef SUNDER_GMSH
#include "verification/first_growth.hpp"
#endif
#include "verification/sections.hpp"

namespace sunder::test {
namespace {

const Page& page() {
  static const Page committed(SUNDER_SOURCE "/docs/verification.md");
  return committed;
}

void expect_cell(const std::string& section, const std::vector<std::string>& key,
                 const std::string& column, const std::string& ours) {
  const std::string committed = page().cell(section, key, column);
  EXPECT_TRUE(same_digits(committed, ours))
      << section << ", row " << key.front() << ", column " << column << ": the page has "
      << committed << ", the run " << ours << "; write it anew with: verification "
      << "docs/verification.md";
}

TEST(PooledVolume, IsThatOfThePage) {
  const LameErrors errors = lame_errors(MaterialVolume::pooled, 0.4999, 12);
  expect_cell("Thick cylinder, pooled volume", {"0.4999"}, "pooled: displacement",
              text("%+.2f %%", 100 * errors.u));
  expect_cell("Thick cylinder, pooled volume", {"0.4999"}, "pooled: stress",
              text("%.2f %%", 100 * errors.tresca));
  expect_cell("Cook's membrane, pooled volume", {"32 x 32"}, "pooled [mm]",
              text("%.3f", incompressible_cook(MaterialVolume::pooled, 32)));
  expect_cell("Cook's membrane, pooled volume, law neo-hookean", {"16 x 16"}, "pooled [mm]",
              text("%.3f", neo_hookean_cook(MaterialVolume::pooled, 16, 4)));
  expect_cell("Bonded block, pooled volume", {"1536"}, "pooled [N]",
              text("%.2f", bonded_block_force(MaterialVolume::pooled, 8)));
}

TEST(Peeling, IsThatOfThePage) {
  const PeelFigures of = peel(Peel::at_90, 1);
  const std::vector<std::string> key{name_of(Peel::at_90), text("%g", coarse_cell(Peel::at_90))};
  expect_cell("Peeling", key, "mean", text("%.3f", of.mean));
  expect_cell("Peeling", key, "work", text("%.3f", of.work));
}

class Strips : public ::testing::TestWithParam<Notch> {
 protected:
  [[nodiscard]] static std::string section() {
    return (GetParam() == Notch::edge ? "Single edge notch" : "Centre crack") +
           std::string(" in tension, F(a/W)");
  }
};

TEST_P(Strips, AreThoseOfThePage) {
  for (int tenths = 1; tenths <= 6; ++tenths) {
    const double share = tenths / 10.0;
    const bool edge = GetParam() == Notch::edge;
    const double reference = edge ? tada_edge(share) : tada_centre(share);
    const Factor f = notch_factor(GetParam(), 20, share);
    const std::vector<std::string> key{text("%.1f", share)};
    expect_cell(section(), key, "Tada", text("%.4f", reference));
    expect_cell(section(), key, "W/20", text("%.4f", f.value));
    expect_cell(section(), key, "error W/20", percent(f.value / reference));
  }
}

TEST_P(Strips, AreThoseOfThePageOnAFinerMesh) {
  expect_cell(section(), {"0.4"}, "W/40", text("%.4f", notch_factor(GetParam(), 40, 0.4).value));
}

INSTANTIATE_TEST_SUITE_P(Page, Strips, ::testing::Values(Notch::edge, Notch::centre));

TEST(VerificationPage, HasTheAngledCrack) {
  for (int degrees : {0, 30}) {
    const Intensity k = angled_intensity(degrees);
    const std::vector<std::string> key{std::to_string(degrees)};
    expect_cell("Angled crack in tension", key, "K_I, ours", text("%.4f", k.k_1));
    expect_cell("Angled crack in tension", key, "K_II, ours", text("%.4f", k.k_2));
  }
}

TEST(VerificationPage, HasTheForcePair) {
  expect_cell("Pairs of forces on the faces", {"6.1875"}, "K_I, ours",
              text("%.4f", force_pair_intensity(6.1875)));
}

TEST(VerificationPage, HasTheEnergyRelease) {
  expect_cell("Energy release", {"0.5", "W/20"}, "K, energy",
              text("%.4f", energy_release_intensity(Notch::edge, 20, 0.5)));
}

TEST(VerificationPage, HasTheAntiplaneCrack) {
  expect_cell("Edge crack under antiplane shear, K_III", {"0.4"}, "W/20",
              text("%.4f", antiplane_factor(20, 0.4)));
}

TEST(VerificationPage, HasSplitNodesAndRemainingStiffness) {
  CrackedBoardOptions options;
  options.made = CrackMade::split;
  expect_cell("Split nodes", {"0.5"}, "W/20",
              percent(notch_factor(Notch::edge, 20, 0.5, options).value / tada_edge(0.5)));
  options = {};
  options.alpha = 1e-6;
  expect_cell("What alpha leaves of a destroyed element", {"1e-06"}, "W/20",
              percent(notch_factor(Notch::edge, 20, 0.6, options).value / tada_edge(0.6)));
}

TEST(VerificationPage, HasTheCantileverAndCook) {
  expect_cell("Cantilever", {"480"}, "ours [mm]", text("%.4f", mean_end_deflection(2, 1)));
  expect_cell("Cook's membrane, plane strain", {"16 x 16"}, "ours [mm]",
              text("%.3f", cook_deflection(Plane::strain, 16)));
  expect_cell("Cook's membrane, plane stress", {"16 x 16"}, "ours [mm]",
              text("%.3f", cook_deflection(Plane::stress, 16)));
}

#ifdef SUNDER_GMSH
TEST(VerificationPage, HasTheFirstGrowth) {
  const NotchedBoard notched = notched_board(kBoardSizes[0]);
  const std::vector<std::string> key{std::to_string(notched.tets)};
  expect_cell("First growth", key, "force by K_c [N]", text("%.4f", notched.force));
  expect_cell("First growth", key, "force by Eq. 1 [N]", text("%.3f", notched.force_by_eq1));
  const HoledBoard holed = holed_board(kHoleSizes[0]);
  expect_cell("First growth", {std::to_string(holed.tets)}, "force, averaging 3 mm [N]",
              text("%.2f", holed.force));
}

TEST(VerificationPage, HasTheGrowthOfASplitCrack) {
  const GrownBoard grown = grown_board(kBoardSizes[0]);
  const std::vector<std::string> key{std::to_string(grown.tets), text("%.3f", grown.h),
                                     "force [N]"};
  expect_cell("First growth", key, "x = 12", text("%.3f", grown.force.front()));
  expect_cell("First growth", key, "20 mm", text("%.3f", grown.force.back()));
}

TEST(VerificationPage, HasTheFirstGrowthOfATurnedBoard) {
  const TurnedBoard turned = turned_board(kBoardSizes[0]);
  expect_cell("First growth", {std::to_string(turned.tets)}, "extension [mm]",
              text("%.4f", turned.extension));
}
#endif

TEST(VerificationPage, NothingOnItMissesItsTarget) {
  std::ifstream in(SUNDER_SOURCE "/docs/verification.md");
  std::string row;
  while (std::getline(in, row)) EXPECT_EQ(row.find("**"), std::string::npos) << row;
}

TEST(PageReader, ComparesToTheLastDigit) {
  EXPECT_TRUE(same_digits("1.3626", "1.3627"));
  EXPECT_FALSE(same_digits("1.3626", "1.3628"));
  EXPECT_TRUE(same_digits("-0.29 %", "-0.28 %"));
  EXPECT_FALSE(same_digits("-0.29 %", "-0.29"));
  EXPECT_FALSE(same_digits("1.3626", "-"));
  EXPECT_THROW((void)page().cell("Cantilever", {"481"}, "ours [mm]"), std::runtime_error);
  EXPECT_THROW((void)page().cell("Cantilever", {"480"}, "theirs [mm]"), std::runtime_error);
  EXPECT_THROW((void)page().cell("Beam", {"480"}, "ours [mm]"), std::runtime_error);
}

}  // namespace
}  // namespace sunder::test
