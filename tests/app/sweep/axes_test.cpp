// SPDX-License-Identifier: Apache-2.0
// What --vary says: values by hand, and each wrong one refused in a sentence.
#include "app/sweep/axes.hpp"

#include <gtest/gtest.h>

#include "app/sweep/order.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app::sweep;
using Values = std::vector<std::string>;

TEST(Axes, ListsAreSplitAtCommasOutsideBracketsAndQuotes) {
  const Axis plain = parse_axis("material.upper.yield=1, 2.5 ,3e0");
  EXPECT_EQ(plain.key, "material.upper.yield");
  EXPECT_EQ(plain.values, (Values{"1", "2.5", "3e0"}));
  EXPECT_EQ(parse_axis("instrument.0.force=[0,-50,0],[0,[1,2],{a=1,b=2}]").values,
            (Values{"[0,-50,0]", "[0,[1,2],{a=1,b=2}]"}));
  EXPECT_EQ(parse_axis(R"(title="a,b",'c,"d',"e\"f")").values,
            (Values{R"("a,b")", R"('c,"d')", R"("e\"f")"}));
  EXPECT_EQ(parse_axis("fracture.model=B").values, Values{"B"});
  EXPECT_EQ(parse_axis("material.\"a=b\".young=1").key, "material.\"a=b\".young");
}

TEST(Axes, RangesReachBothEnds) {
  EXPECT_EQ(parse_axis("time.steps=10:50:5").values, (Values{"10", "20", "30", "40", "50"}));
  EXPECT_EQ(parse_axis("x.y=1:-1:3").values, (Values{"1", "0", "-1"}));
  EXPECT_EQ(parse_axis("x.y=0:0.3:4").values.back(), "0.3");
  // No range: words with colons, and two numbers.
  EXPECT_EQ(parse_axis("x.y=a:b:c").values, Values{"a:b:c"});
  EXPECT_EQ(parse_axis("x.y=1:2").values, Values{"1:2"});
}

TEST(Axes, SeveralMultiplyTheFirstTheSlowest) {
  const std::vector<Axis> axes = parse_axes({"a=1,2", "b=x,y,z"});
  EXPECT_EQ(run_count(axes), 6);
  EXPECT_EQ(values_of(axes, 0), (Values{"1", "x"}));
  EXPECT_EQ(values_of(axes, 2), (Values{"1", "z"}));
  EXPECT_EQ(values_of(axes, 3), (Values{"2", "x"}));
  EXPECT_EQ(places_of(axes, 5), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(overrides_at(axes, {1, 0}), (Values{"a=2", "b=x"}));
}

TEST(Axes, RunsOfOneBodyAreComputedTogether) {
  const std::vector<Axis> axes = parse_axes({"load=1,2", "young=5,6,7"});
  const std::vector<bool> bodies{false, true};  // the faster axis makes other bodies
  EXPECT_EQ(runs_to_do(axes, {}, {}, bodies), (std::vector<RunIndex>{0, 3, 1, 4, 2, 5}));
  EXPECT_EQ(runs_to_do(axes, {}, {{3, ""}, {1, ""}}, bodies), (std::vector<RunIndex>{0, 4, 2, 5}));
  // Part 2 of 4 has the runs that leave 1: 1 and 5.
  EXPECT_EQ(runs_to_do(axes, {2, 4}, {}, bodies), (std::vector<RunIndex>{1, 5}));
}

TEST(Axes, PartsHaveEachRunOnce) {
  for (int n = 1; n <= 7; ++n) {
    RunIndex sum = 0;
    for (int i = 1; i <= n; ++i) {
      const Part part{i, n};
      RunIndex count = 0;
      for (RunIndex run = 0; run < 5; ++run) count += part.has(run) ? 1 : 0;
      EXPECT_EQ(part.count(5), count) << i << " of " << n;
      sum += count;
    }
    EXPECT_EQ(sum, 5);
  }
}

struct WrongAxis {
  const char* text;
  const char* why;
};

TEST(Axes, WrongOnesAreRefused) {
  for (const auto& [text, why] : {
           WrongAxis{"", "allowed is KEY.PATH=A,B,C"},
           WrongAxis{"time.steps", "allowed is KEY.PATH=A,B,C"},
           WrongAxis{"=1,2", "allowed is KEY.PATH=A,B,C"},
           WrongAxis{"a=", "a value is empty"},
           WrongAxis{"a=1,,2", "a value is empty"},
           WrongAxis{"a=1,2,1", "the value \"1\" comes twice"},
           WrongAxis{"a=[1,2", "a bracket is not closed"},
           WrongAxis{"a=1],2", "a bracket closes that none has opened"},
           WrongAxis{"a=\"x,y", "a quote is not closed"},
           WrongAxis{"a=1:2:0", "a whole number from 2 to 10000000"},
           WrongAxis{"a=1:2:1", "a whole number from 2 to 10000000"},
           WrongAxis{"a=1:2:x", "a whole number from 2 to 10000000"},
           WrongAxis{"a=1:2:99999999999", "a whole number from 2 to 10000000"},
           WrongAxis{"a=nan:2:3", "both ends have to be finite"},
           WrongAxis{"a=1:inf:3", "both ends have to be finite"},
           WrongAxis{"a=3:3:4", "comes twice"},
       }) {
    try {
      static_cast<void>(parse_axis(text));
      ADD_FAILURE() << text;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find("--vary is \""), 0U) << error.what();
    }
  }
  EXPECT_THROW(static_cast<void>(parse_axes({})), UsageError);
  EXPECT_THROW(static_cast<void>(parse_axes({"a=1", "a=2"})), UsageError);
  EXPECT_THROW(static_cast<void>(parse_axes({"a=1:2:9999", "b=1:2:9999"})), UsageError);
}

}  // namespace
}  // namespace sunder::test
