// SPDX-License-Identifier: Apache-2.0
#include "app/output/text.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/output/run_record.hpp"
#include "app/output/tables.hpp"

namespace sunder::app {
namespace {

TEST(Text, NumbersAreTheShortestThatReadBack) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(5.0), "5");
  EXPECT_EQ(number(-1e-300), "-1e-300");
  EXPECT_EQ(number(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(number(1e23), "1e+23");
}

TEST(Text, ForPeople) {
  EXPECT_EQ(rounded(1.0 / 3, 3), "0.333");
  EXPECT_EQ(grouped(1234567), "1,234,567");
  EXPECT_EQ(grouped(-1234), "-1,234");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(counted(1, "event"), "1 event");
  EXPECT_EQ(counted(1, "tetrahedron", "tetrahedra"), "1 tetrahedron");
  EXPECT_EQ(counted(1954, "tetrahedron", "tetrahedra"), "1,954 tetrahedra");
  EXPECT_EQ(counted(1200, "event"), "1,200 events");
  EXPECT_EQ(byte_size(1023), "1023 B");
  EXPECT_EQ(byte_size(1536), "1.5 KiB");
  EXPECT_EQ(byte_size(3.7 * 1024 * 1024), "3.7 MiB");
}

TEST(Text, EscapesMarkup) {
  EXPECT_EQ(escaped("<a href=\"x\">'&\n"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp; ");
}

TEST(Text, Base64PadsAsTheStandardSays) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Statistics, MedianAndNearestRank) {
  const TimeStatistics odd = statistics({5, 1, 3});
  EXPECT_EQ(odd.min, 1);
  EXPECT_EQ(odd.median, 3);
  EXPECT_EQ(odd.p99, 5);
  EXPECT_EQ(odd.max, 5);
  EXPECT_EQ(odd.sum, 9);
  EXPECT_EQ(statistics({4, 1, 2, 3}).median, 2.5);
  std::vector<double> two_hundred;
  for (int i = 1; i <= 200; ++i) two_hundred.push_back(i);
  EXPECT_EQ(statistics(two_hundred).p99, 198);
  EXPECT_EQ(statistics(std::vector<double>{}).max, 0);
}

TEST(Tables, EventRowsLeaveEmptyWhatDoesNotApply) {
  const std::string header = events_header();
  const auto columns = 1 + std::count(header.begin(), header.end(), ',');
  DestroyedElement record;
  record.step = 2;
  record.event = 7;
  record.element = 42;
  record.cause = Cause::script;
  record.load_factor = 0.25;
  const auto expect_row = [&](const std::string& documented) {
    const std::string row = events_row(record);
    EXPECT_TRUE(row.starts_with(documented)) << row;  // further columns may follow
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), columns - 1) << row;
    EXPECT_EQ(row.back(), '\n');
  };
  expect_row("2,7,42,script,,,0.25,,,,,,,,,,,");
  record.cause = Cause::mss;
  record.crack = 3;
  record.ratio = 1.5;
  expect_row("2,7,42,mss,3,1.5,0.25,,,,,,,,,,,");
  record.cause = Cause::sif;
  record.sif = SifTerms{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  expect_row("2,7,42,sif,3,1.5,0.25,1,2,3,4,5,6,7,8,9,10,11,,,,,,,,,0");
  record.sif->k_1 = 12;
  record.sif->k_2 = -13;
  record.sif->k_3 = 0;
  record.sif->k_formula = 14;
  record.sif->theta_formula = 15;
  record.sif->k_field = 16;
  record.sif->theta_field = -17;
  record.sif->field_note = "material+fixed";
  expect_row(
      "2,7,42,sif,3,1.5,0.25,1,2,3,4,5,6,7,8,9,10,11,12,-13,0,14,15,16,-17,material+fixed,"
      "0");
  // By toughness Eq. 1's reach has no say.
  record.sif->toughness = 2.5;
  record.sif->advance = 1.25;
  expect_row(
      "2,7,42,sif,3,1.5,0.25,1,2,3,4,5,6,,8,9,10,11,12,-13,0,14,15,16,-17,material+fixed,"
      "1.25");
}

TEST(Tables, TipRowsFollowTheirHeader) {
  TipState tip;
  tip.crack = 1;
  tip.position = Vec3(2, 3, 4);
  EXPECT_EQ(tips_row(7, tip), "7,1,0,2,3,4,,,,,,,,\n");
  tip.k = 5;
  tip.theta = 6;
  tip.j = 0.5;
  tip.toughness = 7.5;
  tip.field_note = "strain";
  EXPECT_EQ(tips_row(7, tip), "7,1,0,2,3,4,5,6,,,,0.5,7.5,strain\n");
}

TEST(Tables, FrameRowsFollowTheirHeader) {
  StepReport report;
  report.step = 1;
  report.load_factor = 0.5;
  report.events = 2;
  report.destroyed = 3;
  report.compliance = 4;
  report.residual = 5;
  report.error = 6;
  report.max_yield_ratio = 7;
  report.times = {8, 9, 10, 11, 12, 13};
  report.iterations = 14;
  report.back_solves = 15;
  EXPECT_EQ(frames_header(),
            "step,load_factor,events,destroyed,compliance,residual,error,max_yield_ratio,"
            "ms_load,ms_solve,ms_stress,ms_decide,ms_update,ms_total,iterations,"
            "ms_gpu_solve,ms_gpu_stress,ms_gpu_residual,ms_gpu_estimate,ms_gpu_refine,"
            "ms_gpu_update,strain_max,rotation_max_deg,inverted,back_solves,time,kinetic,"
            "strain_energy,work,dissipated,momentum_x,momentum_y,momentum_z\n");
  EXPECT_EQ(frames_row(report), "1,0.5,2,3,4,5,6,7,8,9,10,11,12,13,14,,,,,,,,,,15,,,,,,,,\n");
  report.deformation = Deformation{-0.125, 12.5, 3};
  EXPECT_EQ(frames_row(report),
            "1,0.5,2,3,4,5,6,7,8,9,10,11,12,13,14,,,,,,,-0.125,12.5,3,15,,,,,,,,\n");
  report.passes = {{"stress", 0.25}, {"solve", 0.5}};
  EXPECT_EQ(frames_row(report),
            "1,0.5,2,3,4,5,6,7,8,9,10,11,12,13,14,0.5,0.25,0,0,0,0,-0.125,12.5,3,15,,,,,,,,\n");
  report.motion = MotionState{.time = 16,
                              .kinetic = 17,
                              .strain_energy = 18,
                              .work = 19,
                              .damped = 1,
                              .scheme = 2,
                              .broken = 4,
                              .unsolved = 8,
                              .momentum = Vec3(21, 22, 23)};
  EXPECT_EQ(frames_row(report),
            "1,0.5,2,3,4,5,6,7,8,9,10,11,12,13,14,0.5,0.25,0,0,0,0,-0.125,12.5,3,15,16,17,18,19,15,"
            "21,22,23\n");
}

}  // namespace
}  // namespace sunder::app
