// SPDX-License-Identifier: Apache-2.0
// summary.json against docs/interface.md "Results".
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <regex>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

const Json& summary() {
  static const Json json = read_json(torn_board() / "summary.json");
  return json;
}

using Keys = std::vector<std::string>;

TEST(Summary, RunSucceeds) {
  EXPECT_EQ(torn_board_outcome().exit_code, 0) << torn_board_outcome().err;
  EXPECT_NE(torn_board_outcome().out.find("500 tetrahedra"), std::string::npos);
}

TEST(Summary, HasTheDocumentedKeysInOrder) {
  const Keys keys = keys_of(summary());
  const Keys documented = {"title",     "mesh",     "device",       "route",         "compliance",
                           "residual",  "error",    "destroyed",    "first_rupture", "cracks",
                           "reactions", "supports", "memory_bytes", "timings_ms",    "warnings"};
  ASSERT_GE(keys.size(), documented.size());
  EXPECT_EQ(Keys(keys.begin(), keys.begin() + static_cast<long>(documented.size())), documented);
  EXPECT_EQ(keys_of(summary()["mesh"]), (Keys{"nodes", "tets", "free_dofs"}));
  EXPECT_EQ(keys_of(summary()["device"]), (Keys{"name", "driver", "backend", "precision"}));
  EXPECT_EQ(keys_of(summary()["route"]), (Keys{"name", "update", "why", "left_out"}));
  EXPECT_EQ(keys_of(summary()["first_rupture"]),
            (Keys{"step", "event", "element", "criterion", "load_factor", "displacement_max",
                  "strain", "rotation_deg"}));
  EXPECT_EQ(keys_of(summary()["timings_ms"]),
            (Keys{"load", "solve", "stress", "decide", "update", "total"}));
  for (const auto& stage : summary()["timings_ms"])
    EXPECT_EQ(keys_of(stage), (Keys{"min", "median", "p99", "max", "sum"}));
  for (const auto& crack : summary()["cracks"])
    EXPECT_EQ(keys_of(crack), (Keys{"id", "kind", "mouth", "tips", "length", "path", "mouth_xyz",
                                    "tips_xyz", "path_xyz"}));
}

TEST(Summary, DescribesTheBoard) {
  EXPECT_EQ(summary()["title"], "Board <pulled> & torn");
  EXPECT_EQ(summary()["mesh"]["nodes"], 242);
  EXPECT_EQ(summary()["mesh"]["tets"], 500);
  EXPECT_EQ(summary()["mesh"]["free_dofs"], 3 * 242 - 3 * 22);  // 22 nodes along the top edge
  EXPECT_EQ(summary()["interrupted"], false);
  EXPECT_EQ(summary()["failure"], nullptr);
  EXPECT_EQ(summary()["steps_done"], 5);
}

TEST(Summary, SaysHowFarTheBodyIsDeformed) {
  const Keys keys = keys_of(summary());
  EXPECT_EQ(Keys(keys.end() - 11, keys.end()),
            (Keys{"largest", "volume_lost", "law", "stress_measure", "motion", "toughness", "crack",
                  "crack_area", "lip_overlap", "new_nodes", "interfaces"}));
  EXPECT_EQ(summary()["crack"], "destroyed");
  EXPECT_TRUE(summary()["crack_area"].is_null());
  EXPECT_TRUE(summary()["lip_overlap"].is_null());
  EXPECT_EQ(summary()["new_nodes"], 0);
  EXPECT_EQ(summary()["law"], "linear");
  EXPECT_TRUE(summary()["stress_measure"].is_null());
  EXPECT_EQ(keys_of(summary()["largest"]), (Keys{"strain", "rotation_deg", "inverted"}));
  const auto frames = read_csv(torn_board() / "frames.csv");
  const auto column =
      std::find(frames[0].begin(), frames[0].end(), "strain_max") - frames[0].begin();
  const Json& first = summary()["first_rupture"];
  double strain = std::abs(first["strain"].get<double>()), rotation = first["rotation_deg"];
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const auto cell = [&](long k) { return std::stod(frames[i][static_cast<std::size_t>(k)]); };
    strain = std::max(strain, std::abs(cell(column)));
    rotation = std::max(rotation, cell(column + 1));
  }
  EXPECT_EQ(std::abs(summary()["largest"]["strain"].get<double>()), strain);
  EXPECT_EQ(summary()["largest"]["rotation_deg"], rotation);
  EXPECT_GT(first["displacement_max"].get<double>(), 0);
  EXPECT_NE(summary()["warnings"].dump().find("strained live tissue by over 10 %"),
            std::string::npos);
  EXPECT_NE(torn_board_outcome().out.find("at the first rupture: largest displacement "),
            std::string::npos);
  // A cell of 5 x 5 x 2 mm has four elements of a sixth of it and one of a third.
  const double lost = summary()["volume_lost"];
  const auto destroyed = static_cast<double>(summary()["destroyed"].size());
  EXPECT_GE(lost, destroyed * 50 / 6 * (1 - 1e-9));
  EXPECT_LE(lost, destroyed * 50 / 3);
}

TEST(Summary, ListsWhatEventsListInOrder) {
  const auto rows = read_csv(torn_board() / "events.csv");
  const Json& destroyed = summary()["destroyed"];
  ASSERT_EQ(rows.size(), destroyed.size() + 1);
  ASSERT_GT(destroyed.size(), 30u);
  const Json* first = nullptr;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][2], std::to_string(destroyed[i - 1].get<int>()));
    if (first || (rows[i][3] != "mss" && rows[i][3] != "sif")) continue;
    first = &summary()["first_rupture"];
    EXPECT_EQ(std::to_string((*first)["step"].get<int>()), rows[i][0]);
    EXPECT_EQ(std::to_string((*first)["event"].get<int>()), rows[i][1]);
    EXPECT_EQ(std::to_string((*first)["element"].get<int>()), rows[i][2]);
    EXPECT_EQ((*first)["criterion"], rows[i][3]);
  }
  EXPECT_NE(first, nullptr);
}

TEST(Summary, CrackPathsRunFromMouthToTip) {
  ASSERT_GE(summary()["cracks"].size(), 1u);
  int id = 0;
  for (const auto& crack : summary()["cracks"]) {
    EXPECT_EQ(crack["id"], id++);
    const Json& path = crack["path"];
    ASSERT_GE(path.size(), 2u);
    const bool edge = crack["kind"] == "edge";
    EXPECT_EQ(crack["tips"].size(), edge ? 1u : 2u);
    EXPECT_EQ(path.front(), edge ? crack["mouth"] : crack["tips"].front());
    EXPECT_EQ(path.back(), crack["tips"].back());
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i)
      length += std::hypot(path[i][0].get<double>() - path[i - 1][0].get<double>(),
                           path[i][1].get<double>() - path[i - 1][1].get<double>());
    EXPECT_NEAR(crack["length"].get<double>(), length, 1e-9 * length);
  }
}

TEST(Summary, ForcesAreInEquilibrium) {
  const Json& pull = summary()["reactions"]["right forceps"];
  EXPECT_EQ(pull, Json::parse("[0, -150, 0]"));
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(summary()["supports"][axis].get<double>() + pull[axis].get<double>(), 0, 1e-5);
}

TEST(Summary, WarnsOfASnapshotThatNeverCame) {
  const std::string warnings = summary()["warnings"].dump();
  EXPECT_NE(warnings.find("no snapshot at 9,000 destroyed elements"), std::string::npos)
      << warnings;
}

/// A processor's name may hold a number ("@ 2.50GHz").
std::string without_strings(const std::string& json) {
  std::string rest;
  bool inside = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (inside && json[i] == '\\') {
      ++i;
    } else if (json[i] == '"') {
      inside = !inside;
    } else if (!inside) {
      rest += json[i];
    }
  }
  return rest;
}

TEST(Summary, NumbersAreShortestRoundTrip) {
  const std::string text = without_strings(read_file(torn_board() / "summary.json"));
  const std::regex decimal("-?[0-9]+(\\.[0-9]+)?(e[-+]?[0-9]+)?");
  const std::regex candidate("[\\[ ]-?[0-9][-+.0-9e]*");
  int checked = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), candidate); i != std::sregex_iterator();
       ++i) {
    const std::string token = i->str().substr(1);
    if (!std::regex_match(token, decimal)) continue;
    double value = 0;
    std::from_chars(token.data(), token.data() + token.size(), value);
    char shortest[40];
    const auto end = std::to_chars(shortest, shortest + sizeof shortest, value).ptr;
    EXPECT_LE(token.size(), static_cast<std::size_t>(end - shortest)) << token;
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace sunder::test
