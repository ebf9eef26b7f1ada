// SPDX-License-Identifier: Apache-2.0
// Lips of split cracks that close: how far they overlap, what keeps them apart, what is left of K.
#include <set>
#include <string>

#include "fracture/split/split_lips.hpp"
#include "measured_split.hpp"
#include "sunder/error.hpp"

namespace sunder {
namespace {

using test::kFar;

constexpr double kSpan = 24;

/// A square in plane strain that stands on its lower side and can widen, with an edge slit of three
/// columns that one event lengthens as a split; then its upper side is pressed down.
Scene pressed(bool contact, double force) {
  Scene scene = test::plane_strain_plate(test::structured_board({24, 24, 1, kSpan, kSpan, 1}), 0.3);
  scene.materials["board"] = {5, 0.3, std::nullopt};
  scene.materials["board"].toughness = 1;
  scene.fracture.sif = SifSource::field;
  scene.fracture.contact = contact;
  scene.fracture.max_events = 4;
  scene.supports.push_back({Box{Vec3(-kFar, -kFar, -kFar), Vec3(kFar, 1e-9, kFar)}, Axes{2}});
  scene.supports.push_back({Box{Vec3(-kFar, -kFar, -kFar), Vec3(1e-9, 1e-9, kFar)}, Axes{1}});
  const Box top{Vec3(-kFar, kSpan - 1e-9, -kFar), Vec3(kFar, kFar, kFar)};
  scene.instruments = {{"hand", Pull{top, Vec3(0, force, 0)}, {}}};
  PresetCrack slit;
  slit.elements = Box{Vec3(-1, 11, -9), Vec3(3, 13, 9)};
  slit.mouth = Vec3(0, 12, 0);
  slit.tips = {Vec3(3, 12, 0)};
  scene.cracks = {slit};
  scene.steps = 2;
  return scene;
}

struct Hand {
  explicit Hand(Scene scene)
      : problem(std::make_shared<const Problem>(std::move(scene))),
        run(problem, cpu_reference::create(problem, needs_of(*problem))) {}
  /// Tears by a pull, then presses.
  void tear_then_press(double by) {
    run.step();
    EXPECT_GT(run.backend().node_count(), problem->node_count());
    EXPECT_EQ(run.lip_overlap(), 0);
    run.drive(0, Vec3(0, by, 0));
    report = run.step();
  }
  [[nodiscard]] std::string told() const {
    std::string all;
    for (const std::string& warning : run.warnings()) all += warning + "\n";
    return all;
  }
  /// The widest gap between lips across the path, y, and the deepest overlap.
  [[nodiscard]] std::pair<double, double> gaps() const {
    const auto u = run.displacement();
    double least = 0, most = 0;
    for (const CrackFace& face : run.crack_faces()) {
      for (std::size_t i = 0; i < 3; ++i) {
        const double gap = u[static_cast<std::size_t>(face.left[i])].y() -
                           u[static_cast<std::size_t>(face.right[i])].y();
        least = std::min(least, gap);
        most = std::max(most, gap);
      }
    }
    return {least, most};
  }

  [[nodiscard]] std::set<Index> live_nodes() const {
    std::set<Index> nodes;
    const Mesh mesh = run.mesh();
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
      if (!run.backend().destroyed()[e]) nodes.insert(mesh.tets[e].begin(), mesh.tets[e].end());
    }
    return nodes;
  }

  std::shared_ptr<const Problem> problem;
  Simulation run;
  StepReport report;
};

/// A crack to the middle of a plate under a uniform press: kept apart, its lips bear what the whole
/// body would, and displacement is that of uniform compression.
TEST(SplitContact, AClosedCrackBearsAsIfThereWereNone) {
  constexpr double kPress = 0.1, kPoisson = 0.3;  // E = 1 MPa: compressed by a tenth
  std::mt19937 random(5);
  for (const double shaken : {0.0, 0.2}) {
    Scene scene = test::plane_strain_plate(
        test::shaken_board({24, 24, 2, kSpan, kSpan, 2}, random, shaken), kPoisson);
    scene.fracture.contact = true;
    scene.supports.push_back({Box{Vec3(-kFar, -kFar, -kFar), Vec3(kFar, 1e-9, kFar)}, Axes{2}});
    scene.supports.push_back({Box{Vec3(-kFar, -kFar, -kFar), Vec3(1e-9, 1e-9, kFar)}, Axes{1}});
    test::MeasuredSplit plate(std::move(scene));
    test::EdgeSplit& crack = plate.crack();
    plate.follow(crack.begin(0));
    while (crack.tip().x() < kSpan / 2) plate.follow(crack.advance(0));
    plate.load(test::traction_of(
        plate.problem().mesh(), [](const Vec3& x) { return x.y() > kSpan - 1e-9; },
        [](const Vec3&) { return Mat3(Vec3(0, -kPress, 0).asDiagonal()); }));
    fracture::SplitLips lips(plate.problem(), crack.board);
    int solutions = 0;
    LipState found;
    do {
      const auto u = plate.displacement();
      FractureState state{plate.problem(), crack.destroyed, {}, {}, {}, Vec3::Zero(), {}};
      state.displacement = [&](std::span<const Index> nodes, std::span<Vec3> at) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
          at[i] = u[static_cast<std::size_t>(nodes[i])];
      };
      found = lips.look(crack.faces(), std::vector<Crack>{crack.crack}, state);
      if (!found.change.ties.empty()) plate.backend().change(found.change);
    } while (!found.change.ties.empty() && ++solutions < 20);
    EXPECT_LT(solutions, 10);
    const double h = crack.board.h();
    EXPECT_GT(found.overlap, 0);
    EXPECT_LT(found.overlap, 0.01 * h);
    EXPECT_TRUE(lips.pressed_near(0, crack.crack.tips[0].position, 2 * h));
    const auto u = plate.displacement();
    const auto& nodes = plate.problem().mesh().nodes;
    const double largest = kPress * (1 - kPoisson * kPoisson) * kSpan;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Vec3 uniform(kPress * kPoisson * (1 + kPoisson) * nodes[n].x(),
                         -kPress * (1 - kPoisson * kPoisson) * nodes[n].y(), 0);
      EXPECT_LE((u[n] - uniform).norm(), 1e-3 * largest) << n;
    }
  }
}

/// In a run: pulled until it tears, then pressed.
TEST(SplitContact, KeepsTheLipsOfARunApart) {
  constexpr double kPress = -6;  // .25 MPa, 4.5 % of compression
  Hand apart(pressed(true, 20));
  apart.tear_then_press(kPress);
  const double h = test::EdgeSplit(*apart.problem).board.h();
  EXPECT_LE(apart.report.error, 1e-8);
  EXPECT_GT(apart.run.lip_overlap(), 0);  // a spring gives by what it bears
  EXPECT_LT(apart.run.lip_overlap(), 0.01 * h);
  const double least = apart.gaps().first;
  EXPECT_GT(least, -0.01 * h);
  EXPECT_EQ(apart.told().find("pass through"), std::string::npos) << apart.told();
  // The slit itself, of destroyed elements, is a hole: the same crack free to overlap is softer.
  Hand free(pressed(false, 20));
  free.tear_then_press(kPress);
  EXPECT_LT(free.gaps().first, 5 * least);
  EXPECT_GT(free.run.lip_overlap(), 0.01 * h);
  // Across the path, which is nearly level.
  EXPECT_NEAR(free.run.lip_overlap(), -free.gaps().first, 0.2 * free.run.lip_overlap());
  EXPECT_NE(free.told().find("pass through"), std::string::npos) << free.told();
  EXPECT_GT(free.report.compliance, apart.report.compliance);
}

/// Lips that overlap show no K_I, with contact and without, and say so.
TEST(SplitContact, AClosedTipHasNoIntensityAndSaysSo) {
  for (const bool contact : {true, false}) {
    Hand hand(pressed(contact, 20));
    hand.tear_then_press(-6);
    const auto tips = hand.run.tips();
    ASSERT_EQ(tips.size(), 1U);
    ASSERT_TRUE(tips[0].k_1);
    EXPECT_EQ(*tips[0].k_1, 0) << contact;
    EXPECT_NE(std::string(tips[0].field_note).find("closed"), std::string::npos)
        << contact << " " << tips[0].field_note;
    EXPECT_LT(*tips[0].k, 0.05 * 1);  // a symmetric load: nothing slides
  }
}

/// Springs go where lips part again: pulled after the press the body is as one never pressed.
TEST(SplitContact, LipsThatPartAgainAreFree) {
  Scene scene = pressed(true, 20);
  scene.steps = 3;
  Hand hand(std::move(scene));
  hand.tear_then_press(-6);
  hand.run.drive(0, Vec3(0, 0.5, 0));  // too little to tear
  const int before = hand.run.backend().node_count();
  hand.run.step();
  ASSERT_EQ(hand.run.backend().node_count(), before);
  EXPECT_EQ(hand.gaps().first, 0) << "a lip is still held";
  EXPECT_GT(hand.gaps().second, 0);
  // Linear: a twelfth of the press the other way, without contact.
  Scene once = pressed(false, 20);
  Hand free(std::move(once));
  free.tear_then_press(0.5);
  const auto a = hand.run.displacement(), b = free.run.displacement();
  ASSERT_EQ(a.size(), b.size());
  double largest = 0, difference = 0;
  const std::set<Index> live = hand.live_nodes();  // others hang on what the slit has left
  for (const Index node : live) {
    const auto n = static_cast<std::size_t>(node);
    largest = std::max(largest, b[n].norm());
    difference = std::max(difference, (a[n] - b[n]).norm());
  }
  EXPECT_LE(difference, 1e-8 * largest);
}

TEST(SplitContact, RefusedWhereNothingCanDoIt) {
  const auto refused = [](Scene scene) -> std::string {
    try {
      const auto problem = std::make_shared<const Problem>(std::move(scene));
      static_cast<void>(cpu_reference::create(problem, needs_of(*problem)));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Scene whole = pressed(true, 20);
  whole.fracture.crack = CrackWay::destroyed;
  EXPECT_NE(refused(whole).find("fracture.contact = true needs fracture.crack = \"split\""),
            std::string::npos);
}

}  // namespace
}  // namespace sunder
