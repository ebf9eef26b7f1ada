// SPDX-License-Identifier: Apache-2.0
// Notches that belong to the mesh's shape: field K against the published one of the sharp crack of
// the same length, or none, with the reason.
#include "fracture/field_sif/notch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/field_sif/held_strip.hpp"
#include "core/field_sif/published.hpp"
#include "core/field_sif/shaped_notch.hpp"

namespace sunder::test {
namespace {

constexpr double kPromise = 0.03;      // of the published K, docs/method.md "Field K"
constexpr double kOfTheFamily = 0.02;  // W/20 to W/80, a/W .2 to .5; measured 1.6 %

double published(int n, int cells) {
  const double a = cells;
  return tada_edge(a / n) * std::sqrt(std::numbers::pi * a);
}

struct Case {
  const char* name;
  CrackedBody body;
  int n, cells;
};

TEST(Notch, SlotIsACrackOfItsLength) {
  // W = 20 mm with cells of .5 mm: slots .5 and 1 mm wide, and of .25 mm: .25 and .5 mm.
  for (const auto& [n, cells, rows] :
       {std::tuple{40, 14, 1}, std::tuple{80, 28, 1}, std::tuple{80, 28, 2}}) {
    CrackedBody body = slotted_strip(n, cells, rows);
    const auto measured = body.chosen_intensity(0);
    EXPECT_FALSE(measured.disturbed.notch);
    EXPECT_NEAR(measured.factors.k_1 / published(n, cells), 1, kPromise) << n << " " << rows;
    EXPECT_LT(std::abs(measured.factors.k_2 / measured.factors.k_1), 0.01);
  }
}

TEST(Notch, RoundEndIsSharperThanAFlatOne) {
  const double width = 2;  // .5 mm where W is 20 mm
  CrackedBody round = opened_strip(80, 28, [&](double behind) {
    return behind >= width / 2 ? width / 2 : std::sqrt(behind * (width - behind));
  });
  const auto measured = round.chosen_intensity(0);
  EXPECT_FALSE(measured.disturbed.notch);
  EXPECT_NEAR(measured.factors.k_1 / published(80, 28), 1, kPromise);
  CrackedBody flat = slotted_strip(80, 28, 2);
  EXPECT_NEAR(flat.chosen_intensity(0).factors.k_1 / published(80, 28), 1, kPromise);
  EXPECT_LT(round.intensity(8).factors.k_1, flat.intensity(8).factors.k_1);  // nothing taken off
}

TEST(Notch, NarrowSlotIsTheSplitCrack) {
  // .1 mm in a strip 20 mm wide, its end drawn in over a cell of .5 mm: the mesh owes what it owes
  // the same crack of split nodes.
  const auto slot = [](double width) {
    return [width](double behind) { return width / 2 * std::sqrt(std::min(1.0, behind)); };
  };
  CrackedBody closed = v_strip(40, 14, 0), open = opened_strip(40, 14, slot(0.2));
  const double of_closed = closed.intensity(8).factors.k_1;
  EXPECT_NEAR(open.intensity(8).factors.k_1 / of_closed, 1, 0.005);
  EXPECT_NEAR(open.chosen_intensity(0).factors.k_1 / published(40, 14), 1, kOfTheFamily);
}

TEST(Notch, VIsACrackOfItsDepth) {
  // Without what the tips' shift brings: -5.9 to -10.6 % at W/20, -3.4 to -5.5 % at W/40.
  for (const auto& [n, cells] :
       {std::pair{20, 4}, std::pair{20, 7}, std::pair{20, 10}, std::pair{40, 8}, std::pair{40, 14},
        std::pair{40, 20}, std::pair{80, 28}}) {
    for (double degrees : {10., 45., 60.}) {
      CrackedBody body = v_strip(n, cells, degrees);
      const auto measured = body.chosen_intensity(0);
      EXPECT_EQ(measured.note(), "") << n << " " << cells << " " << degrees;
      EXPECT_NEAR(measured.factors.k_1 / published(n, cells), 1, kOfTheFamily)
          << n << " " << cells << " " << degrees;
    }
  }
}

TEST(Notch, CoarseMeshIsRightOrSaysSo) {
  int left_out = 0;
  for (const auto& [n, cells] : {std::pair{10, 2}, std::pair{10, 4}, std::pair{10, 5},
                                 std::pair{10, 8}, std::pair{20, 12}, std::pair{20, 16}}) {
    for (double degrees : {10., 60.}) {
      CrackedBody body = v_strip(n, cells, degrees);
      const auto measured = body.chosen_intensity(0);
      if (measured.note().empty()) {
        EXPECT_NEAR(measured.factors.k_1 / published(n, cells), 1, kPromise) << n << " " << cells;
        continue;
      }
      EXPECT_EQ(measured.note(), "coarse") << n << " " << cells << " " << degrees;
      EXPECT_TRUE(measured.disturbed.left_out);
      ++left_out;
    }
  }
  EXPECT_GE(left_out, 4);
}

TEST(Notch, SplitCrackKeepsItsKAndSaysWhatTheMeshOwes) {
  CrackedBody coarse = v_strip(40, 14, 0), fine = v_strip(80, 28, 0);
  const auto measured = coarse.chosen_intensity(0);
  EXPECT_EQ(measured.note(), "coarse");
  EXPECT_FALSE(measured.disturbed.left_out);
  EXPECT_EQ(measured.factors.k_1, coarse.intensity(measured.radius).factors.k_1);
  EXPECT_LT(measured.factors.k_1 / published(40, 14), 1 - kPromise);
  const auto of_fine = fine.chosen_intensity(0);
  EXPECT_EQ(of_fine.note(), "");
  EXPECT_NEAR(of_fine.factors.k_1 / published(80, 28), 1, kPromise);
}

// What stands beside the formula's K in events.csv.
TEST(Notch, SplitCrackSaysByTheFormulaToo) {
  Scene scene = v_strip(40, 14, 0).problem().scene();
  scene.fracture.model = FractureModel::b;
  scene.fracture.sif = SifSource::formula;
  const double y = scene.cracks[0].tips[0].y();
  CrackedBody body(std::move(scene));
  body.set_crack(CrackKind::edge, {0, y}, {14, y}, {});
  body.load_uniform(0, 1, 0);
  body.solve();
  EXPECT_EQ(body.chosen_intensity(0).note(), "coarse");
}

TEST(Notch, InternalOneUnderShearToo) {
  // Turning the load instead of the crack by 30 degrees, in a plate 20 a wide.
  const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
  for (const auto& [cells, degrees] : {std::pair{4, 10.}, std::pair{10, 10.}, std::pair{10, 45.}}) {
    CrackedBody body = opened_plate(cells, degrees);
    body.load_uniform(s * s, c * c, s * c);
    body.solve();
    const double k = std::sqrt(std::numbers::pi * cells) * tada_centre(0.1);
    for (std::size_t tip : {0, 1}) {
      const auto measured = body.chosen_intensity(tip);
      EXPECT_EQ(measured.note(), "");
      EXPECT_NEAR(measured.factors.k_1 / (k * c), c, kPromise) << cells << " " << degrees;
      EXPECT_NEAR(measured.factors.k_2 / (k * c), s, kPromise) << cells << " " << degrees;
    }
  }
  CrackedBody lozenge = opened_plate(10, 60);
  EXPECT_EQ(lozenge.chosen_intensity(0).note(), "notch");
}

TEST(Notch, WhatItsAngleCosts) {
  // K_II of a V in shear against that of the split crack, 14 and 28 h long: -2.1 % (30 degrees),
  // -7.9 % (60), then -7.0 and -19.7 %; K_I -.2, -1.3, -.2 and -1.9 %.
  const auto share = [](double degrees, double a, const Vec3& k) {
    fracture::Notch notch;
    notch.angle = degrees * std::numbers::pi / 180;
    return fracture::angle_share(notch, 7.6, a, k);
  };
  EXPECT_GT(share(30, 14, Vec3::UnitY()), 0.02);
  EXPECT_GT(share(60, 14, Vec3::UnitY()), 0.079);
  EXPECT_GT(share(30, 28, Vec3::UnitY()), 0.07);
  EXPECT_GT(share(60, 28, Vec3::UnitY()), 0.197);
  EXPECT_LT(share(60, 28, Vec3::UnitY()), 0.25);
  EXPECT_LT(share(60, 28, Vec3::UnitX()), 0.02);
  EXPECT_EQ(share(60, 28, Vec3::Zero()), 0);
}

TEST(Notch, DomainsAgree) {
  CrackedBody slot = slotted_strip(80, 28, 2), v = v_strip(80, 28, 60);
  for (CrackedBody* body : {&slot, &v}) {
    const double reference = body->intensity(8).factors.k_1;
    for (double radius : {6.0, 10.0, 14.0, 20.0})
      EXPECT_NEAR(body->intensity(radius).factors.k_1 / reference, 1, 0.015) << radius;
  }
}

TEST(Notch, WideOrOpenOnesHaveNoK) {
  std::vector<Case> cases;
  cases.push_back({"slot a seventh of its length wide", slotted_strip(80, 28, 4), 80, 28});
  cases.push_back({"slot as wide as it is deep", slotted_strip(40, 6, 6), 40, 6});
  cases.push_back({"V of 90 degrees", v_strip(40, 14, 90), 40, 14});
  for (Case& c : cases) {
    const auto measured = c.body.chosen_intensity(0);
    EXPECT_TRUE(measured.disturbed.notch) << c.name;
    EXPECT_EQ(measured.note(), "notch") << c.name;
  }
}

TEST(Notch, IsRecognised) {
  const auto notch_of = [](CrackedBody& body) { return body.meter().notch_of(body.crack(), 0); };
  CrackedBody closed = v_strip(40, 14, 0), v = v_strip(40, 14, 60), slot = slotted_strip(40, 14, 3);
  ASSERT_NE(notch_of(closed), nullptr);
  EXPECT_TRUE(notch_of(closed)->closed);
  ASSERT_NE(notch_of(v), nullptr);
  EXPECT_FALSE(notch_of(v)->closed);
  EXPECT_NEAR(notch_of(v)->angle, std::numbers::pi / 3, 0.01);
  EXPECT_NEAR(notch_of(v)->width, 0, 0.01);
  ASSERT_NE(notch_of(slot), nullptr);
  EXPECT_NEAR(notch_of(slot)->width, 3, 1e-9);
  EXPECT_NEAR(notch_of(slot)->angle, 0, 1e-9);
}

TEST(Notch, BluntnessFollowsFromWidthAndPlace) {
  // Shallow: K ~ sqrt(a), so .3 w / (2 a). Deep: K grows faster.
  EXPECT_NEAR(fracture::blunt_share(1, 100, 1e5, true), 0.3 / 200, 1e-5);
  EXPECT_NEAR(fracture::blunt_share(1, 100, 1e5, false), 0.3 / 200, 1e-5);
  EXPECT_GT(fracture::blunt_share(1, 100, 200, true), 3 * 0.3 / 200);
}

/// The held strip with its notch cut out of the mesh; `width` rows of 1 mm.
Scene notched_by_shape(SifSource sif, int rows) {
  Scene scene = cut_out(HeldStrip{}.scene(sif, {0, 8, 0}), [rows](const Vec3& c) {
    return c.x() < 6 && std::abs(c.y() - 10.5) < rows / 2.0;
  });
  scene.cracks[0].elements = std::vector<Index>{};
  return scene;
}

struct FourSteps {
  explicit FourSteps(Scene scene) : FourSteps(std::make_shared<const Problem>(std::move(scene))) {}
  explicit FourSteps(std::shared_ptr<const Problem> problem)
      : simulation(problem, cpu_reference::create(problem, needs_of(*problem))) {
    for (int i = 0; i < 4; ++i) simulation.step();
  }
  [[nodiscard]] int warnings_with(const std::string& words) const {
    const auto all = simulation.warnings();
    return static_cast<int>(std::ranges::count_if(
        all, [&](const std::string& text) { return text.find(words) != std::string::npos; }));
  }
  [[nodiscard]] double place(Index element) const {
    const Mesh& mesh = simulation.problem().mesh();
    double x = 0;
    for (Index n : mesh.tets[element]) x += mesh.nodes[n].x() / 4;
    return x;
  }
  Simulation simulation;
};

TEST(Notch, BluntOneRestsAndSaysSoOnce) {
  FourSteps run(notched_by_shape(SifSource::field, 5));
  const auto tips = run.simulation.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_FALSE(tips[0].k || tips[0].k_1 || tips[0].theta);
  EXPECT_EQ(tips[0].field_note, "notch");
  EXPECT_EQ(run.warnings_with("field K of crack 0 at its tip 0 is not measured"), 1);
  EXPECT_EQ(run.warnings_with("formula"), 0);
  for (const DestroyedElement& row : run.simulation.destroyed()) EXPECT_NE(row.crack, 0);
}

TEST(Notch, FormulaIsLeftOutAndSaysSoOnce) {
  FourSteps run(notched_by_shape(SifSource::formula, 1));
  const auto tips = run.simulation.tips();
  ASSERT_FALSE(tips.empty());
  EXPECT_FALSE(tips[0].k);
  EXPECT_EQ(tips[0].field_note, "notch");
  EXPECT_EQ(run.warnings_with("formula's K of crack 0 is left out"), 1);
}

/// The held strip with a V, so many mm deep, in the place of its notch; 0 degrees: split nodes.
Scene v_by_shape(double degrees, double deep = 6) {
  Scene scene = HeldStrip{}.scene(SifSource::field, {0, 8, 0});
  Mesh& mesh = scene.mesh;
  std::map<Index, Index> copy;
  for (Index n = 0, count = mesh.node_count(); n < count; ++n) {
    const Vec3 x = mesh.nodes[n];
    if (x.y() != 10 || x.x() >= deep) continue;
    copy[n] = mesh.node_count();
    mesh.nodes.push_back(x);
  }
  std::vector<bool> upper(mesh.nodes.size(), false);
  for (auto& tet : mesh.tets) {
    double height = 0;
    for (Index n : tet) height += mesh.nodes[n].y() / 4;
    if (height < 10) continue;
    for (Index& n : tet) {
      if (copy.contains(n)) n = copy[n];
      upper[n] = true;
    }
  }
  const double slope = std::tan(degrees * std::numbers::pi / 360);
  for (Index n = 0; n < mesh.node_count(); ++n) {
    Vec3& x = mesh.nodes[n];
    const double half = slope * std::max(deep - x.x(), 0.0) * (1 - std::abs(x.y() - 10) / 11);
    if (x.y() > 0.5 && x.y() < 20.5) x.y() += upper[n] ? half : -half;
  }
  scene.cracks[0].elements = std::vector<Index>{};
  scene.cracks[0].mouth = Vec3(0, 10, 0.5);
  scene.cracks[0].tips = {Vec3(deep, 10, 0.5)};
  return scene;
}

TEST(Notch, OneOfTooFewElementsIsNotMeasuredAndSaysSoOnce) {
  FourSteps run(v_by_shape(60, 1));  // one element deep
  const auto tips = run.simulation.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_EQ(tips[0].field_note, "coarse");
  EXPECT_FALSE(tips[0].k_1);
  EXPECT_FALSE(tips[0].k);
  EXPECT_EQ(run.warnings_with("the mesh is too coarse for K within 3 %"), 1);
  for (const DestroyedElement& row : run.simulation.destroyed())
    EXPECT_NE(row.cause, Cause::sif) << row.element;
}

TEST(Notch, SplitOneGoesOnAndSaysSoOnce) {
  FourSteps run(v_by_shape(0));
  const auto tips = run.simulation.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_EQ(tips[0].field_note, "coarse");
  EXPECT_GT(tips[0].k_1.value_or(0), 0);
  EXPECT_EQ(run.warnings_with("is more than 3 % low"), 1);
}

TEST(Notch, SplitOneByTheFormulaHasTheFieldsTermsToo) {
  Scene scene = v_by_shape(0);
  scene.fracture.sif = SifSource::formula;
  FourSteps run(std::move(scene));
  const auto grown = [&] {
    return std::ranges::find_if(run.simulation.destroyed(),
                                [](const DestroyedElement& row) { return row.sif.has_value(); });
  };
  const auto none = [&] { return grown() == run.simulation.destroyed().end(); };
  while (!run.simulation.done() && none()) run.simulation.step();
  ASSERT_FALSE(none());
  const auto& sif = grown()->sif;
  EXPECT_GT(sif->k_1.value_or(0), 0);
  EXPECT_EQ(run.warnings_with("takes its remote stress from a mesh whose nodes are split"), 1);
}

TEST(Notch, SharpOneGrowsByTheField) {
  FourSteps run(v_by_shape(20));
  Simulation& simulation = run.simulation;
  while (!simulation.done() && simulation.cracks()[0].length < 12) simulation.step();
  EXPECT_GE(simulation.cracks()[0].length, 12);
  int compared = 0;
  for (const DestroyedElement& row : simulation.destroyed()) {
    if (!row.sif || run.place(row.element) > 12) continue;
    EXPECT_NEAR(*row.sif->k_1 / HeldStrip{}.rice(8 * row.load_factor), 1, 0.1)
        << run.place(row.element);
    EXPECT_EQ(row.sif->field_note, "");
    EXPECT_FALSE(row.sif->k_formula);
    ++compared;
  }
  EXPECT_GT(compared, 5);
  EXPECT_EQ(run.warnings_with("not measured"), 0);
}

}  // namespace
}  // namespace sunder::test
