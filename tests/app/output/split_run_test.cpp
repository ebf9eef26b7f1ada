// SPDX-License-Identifier: Apache-2.0
// A crack that splits by the program: nothing is destroyed, nodes come, its lips are files of their
// own, and what cannot follow it is refused by name.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

constexpr const char* kScene = SUNDER_SOURCE "/scenes/split/board-split.toml";
constexpr std::size_t kSteps = 50, kFilesTets = 1954;

/// One run for all tests of this file.
struct Torn {
  Torn() {
    outcome = run_program({"run", kScene, "--out", (folder / "out").string(), "--quiet", "--series",
                           "--snapshots", "2,900"});
    summary = read_json(folder / "out" / "summary.json");
    events = read_csv(folder / "out" / "events.csv");
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return folder / "out" / name;
  }
  TempFolder folder;
  Outcome outcome;
  nlohmann::ordered_json summary;
  std::vector<std::vector<std::string>> events;
};

const Torn& torn() {
  static const Torn run;
  return run;
}

std::string cell(const std::vector<std::vector<std::string>>& rows, std::size_t row,
                 const std::string& column) {
  const auto at = std::ranges::find(rows.front(), column) - rows.front().begin();
  return rows.at(row).at(static_cast<std::size_t>(at));
}

struct Grid {
  explicit Grid(const std::string& name)
      : file(parse_xml(read_file(torn().file(name)))),
        piece(file.child("UnstructuredGrid").child("Piece")) {}
  template <class T>
  [[nodiscard]] std::vector<T> of(const char* part, const std::string& name) const {
    return values_of<T>(piece.child(part).child("DataArray", name));
  }
  [[nodiscard]] std::size_t count(const char* of_what) const {
    return std::stoul(piece.attributes.at(of_what));
  }
  XmlElement file;
  const XmlElement& piece;
};

TEST(SplitRun, DestroysNothing) {
  ASSERT_EQ(torn().outcome.exit_code, 0) << torn().outcome.err;
  const auto& summary = torn().summary;
  EXPECT_EQ(summary["crack"], "split");
  EXPECT_TRUE(summary["destroyed"].empty());
  EXPECT_EQ(summary["volume_lost"], 0);
  EXPECT_GT(summary["new_nodes"], 0);
  const auto frames = read_csv(torn().file("frames.csv"));
  ASSERT_EQ(frames.size(), kSteps + 1);
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_EQ(cell(frames, i, "destroyed"), "0");
  // What the forceps pull the supports hold.
  EXPECT_NEAR(summary["supports"][1].get<double>(), 9.8, 1e-6);
}

// A birth names the element that asked for it, which lives; growths name none.
TEST(SplitRun, EventsAreOneBirthAndGrowths) {
  const auto& rows = torn().events;
  ASSERT_GT(rows.size(), 4u);
  EXPECT_EQ(cell(rows, 1, "criterion"), "mss");
  const int element = std::stoi(cell(rows, 1, "element"));
  EXPECT_EQ(torn().summary["first_rupture"]["element"], element);
  EXPECT_EQ(Grid("result.vtu")
                .of<std::uint8_t>("CellData", "destroyed")
                .at(static_cast<std::size_t>(element)),
            0);
  double before = 0;
  for (std::size_t i = 2; i < rows.size(); ++i) {
    EXPECT_EQ(cell(rows, i, "criterion"), "sif");
    EXPECT_EQ(cell(rows, i, "element"), "");
    // Without a toughness Eq. 1 has let it pass: r_e against half an edge length.
    EXPECT_GE(std::stod(cell(rows, i, "ratio")), 1);
    EXPECT_GT(std::stod(cell(rows, i, "r")), 0);
    EXPECT_GT(std::stod(cell(rows, i, "advance")), 0);
    const double a = std::stod(cell(rows, i, "a"));
    EXPECT_GT(a, before) << "the length at which K was measured";
    before = a;
  }
  EXPECT_LE(before, torn().summary["cracks"][0]["length"].get<double>());
}

// The area is that of a cut of this length through the thickness of 2 mm, but for a front of faces.
TEST(SplitRun, AreaIsLengthTimesThickness) {
  const double length = torn().summary["cracks"][0]["length"].get<double>();
  EXPECT_NEAR(torn().summary["crack_area"].get<double>(), 2 * length, 0.1 * 2 * length);
}

TEST(SplitRun, ResultHasTheNodesThatCame) {
  const Grid grid("result.vtu");
  const std::size_t of_file = torn().summary["mesh"]["nodes"],
                    new_nodes = torn().summary["new_nodes"];
  ASSERT_EQ(grid.count("NumberOfPoints"), of_file + new_nodes);
  EXPECT_EQ(grid.count("NumberOfCells"), kFilesTets);
  const auto points = grid.of<double>("Points", "points");
  const auto corners = grid.of<std::int32_t>("Cells", "connectivity");
  EXPECT_EQ(grid.of<double>("PointData", "displacement").size(), points.size());
  const Grid before("result_0000.vtu");
  const auto same = before.of<double>("Points", "points");
  const auto intact = before.of<std::int32_t>("Cells", "connectivity");
  ASSERT_EQ(same.size(), 3 * of_file);
  EXPECT_TRUE(std::equal(same.begin(), same.end(), points.begin()));
  // Corners lie where they did; only ids of new nodes are others.
  std::size_t changed = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto now = static_cast<std::size_t>(corners[i]),
               then = static_cast<std::size_t>(intact[i]);
    if (now == then) continue;
    ++changed;
    ASSERT_GE(now, of_file);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(points[3 * now + axis], same[3 * then + axis]);
    }
  }
  EXPECT_GT(changed, new_nodes);
}

double distance_to_path(double x, double y) {
  const auto& path = torn().summary["cracks"][0]["path_xyz"];
  double nearest = 1e9;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const std::array<double, 2> a{path[i - 1][0], path[i - 1][1]}, b{path[i][0], path[i][1]};
    const double dx = b[0] - a[0], dy = b[1] - a[1], size = dx * dx + dy * dy;
    double share = ((x - a[0]) * dx + (y - a[1]) * dy) / size;
    if (i > 1) share = std::max(share, 0.0);
    if (i + 1 < path.size()) share = std::min(share, 1.0);
    nearest = std::min(nearest, std::hypot(x - a[0] - share * dx, y - a[1] - share * dy));
  }
  return nearest;
}

TEST(SplitRun, LipsLieOnTheIdealPathAndGape) {
  const Grid grid("cracks.vtu");
  EXPECT_EQ(grid.piece.child("PointData").array_names(),
            (std::vector<std::string>{"opening", "displacement"}));
  EXPECT_EQ(grid.piece.child("CellData").array_names(),
            (std::vector<std::string>{"crack", "side"}));
  const auto points = grid.of<double>("Points", "points");
  const auto u = grid.of<double>("PointData", "displacement");
  for (std::size_t i = 0; i < points.size(); i += 3) {
    EXPECT_LT(distance_to_path(points[i] - u[i], points[i + 1] - u[i + 1]), 1e-9);
    EXPECT_GE(points[i + 2] - u[i + 2], -1e-9);  // at its thickness
    EXPECT_LE(points[i + 2] - u[i + 2], 2 + 1e-9);
  }
  const auto side = grid.of<std::int32_t>("CellData", "side");
  EXPECT_EQ(std::ranges::count(side, 1), std::ranges::count(side, -1));
  const auto opening = grid.of<double>("PointData", "opening");
  EXPECT_GT(*std::ranges::max_element(opening), 3);
  EXPECT_EQ(*std::ranges::min_element(opening), 0);  // the front
  // The two lips of the mouth are as far apart as one of its points says.
  const auto corners = grid.of<std::int32_t>("Cells", "connectivity");
  for (std::size_t f = 0; f + 1 < side.size(); f += 2) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(corners[3 * f + i]);
      const auto b = static_cast<std::size_t>(corners[3 * f + 3 + i]);
      const double gap =
          std::hypot(u[3 * a] - u[3 * b], u[3 * a + 1] - u[3 * b + 1], u[3 * a + 2] - u[3 * b + 2]);
      EXPECT_LE(gap, opening[a] + 1e-12);
    }
  }
}

TEST(SplitRun, SeriesHasTheLipsOfEveryStep) {
  EXPECT_EQ(Grid("cracks_0000.vtu").count("NumberOfCells"), 0u);
  std::size_t before = 0;
  for (const char* step : {"cracks_0044.vtu", "cracks_0049.vtu"}) {
    const std::size_t cells = Grid(step).count("NumberOfCells");
    EXPECT_GT(cells, before) << step;
    before = cells;
  }
  EXPECT_TRUE(mentions(read_file(torn().file("cracks.pvd")), "cracks_0049.vtu"));
}

TEST(SplitRun, PicturesAndPageShowTheTear) {
  EXPECT_GT(std::filesystem::file_size(torn().file("film.png")), 10000u);
  const std::string film = read_file(torn().file("film.svg"));
  for (const char* caption : {"load 0.86, crack", "load 1, crack"}) {
    EXPECT_TRUE(mentions(film, caption)) << caption;
  }
  const std::string figure = read_file(torn().file("figure.svg"));
  for (const char* part : {"split open", "true scale", "class=\"lip\"", "ideal path"}) {
    EXPECT_TRUE(mentions(figure, part)) << part;
  }
  EXPECT_FALSE(mentions(figure, "class=\"destroyed\""));
  const std::string page = read_file(torn().file("index.html"));
  for (const char* part : {"The tear", "mm² split open", "Along the cracks", "crack length a [mm]",
                           "that made it grow", "at which it grew"}) {
    EXPECT_TRUE(mentions(page, part)) << part;
  }
}

TEST(SplitRun, SnapshotsCountSplits) {
  EXPECT_TRUE(std::filesystem::exists(torn().file("snapshot_2.png")));
  EXPECT_TRUE(mentions(torn().summary["warnings"].dump(), "no snapshot at 900 splits"));
}

TEST(SplitRun, ANewRunTakesItsFilesAway) {
  const TempFolder folder;
  const auto run = [&](const std::string& how) {
    return run_program({"run", kScene, "--out", (folder / "out").string(), "--quiet", "--series",
                        "--steps", "2", "--set", "fracture.crack=" + how});
  };
  ASSERT_EQ(run("split").exit_code, 0);
  for (const char* name : {"cracks.vtu", "cracks_0001.vtu", "cracks.pvd"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
  }
  ASSERT_EQ(run("destroyed").exit_code, 0);
  for (const std::string& name : names_in(folder / "out")) {
    EXPECT_FALSE(name.starts_with("cracks")) << name;
  }
  const auto summary = read_json(folder / "out" / "summary.json");
  EXPECT_EQ(summary["crack"], "destroyed");
  EXPECT_TRUE(summary["crack_area"].is_null());
  EXPECT_TRUE(summary["lip_overlap"].is_null());
  EXPECT_EQ(summary["new_nodes"], 0);
}

TEST(SplitRun, NodesThatAreSpentLeaveTheTipsAtRest) {
  const TempFolder folder;
  const Outcome run = run_program({"run", kScene, "--out", (folder / "out").string(), "--quiet",
                                   "--set", "fracture.max_new_nodes=5"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = read_json(folder / "out" / "summary.json");
  EXPECT_LE(summary["new_nodes"], 5);
  EXPECT_TRUE(mentions(summary["warnings"].dump(), "max_new_nodes")) << summary["warnings"].dump();
}

TEST(SplitRun, BirthByElementsIsNotRead) {
  const TempFolder folder;
  const Outcome run = run_program({"run", kScene, "--out", (folder / "out").string(), "--steps",
                                   "2", "--set", "fracture.birth=through"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(mentions(run.err, "fracture.birth is not read")) << run.err;
}

struct Refused {
  std::vector<std::string> how;
  const char* what;
  const char* instead;
};

TEST(SplitRun, WhatCannotFollowIsRefusedByName) {
  const TempFolder folder;
  const auto outcome = [&](const std::vector<std::string>& how) {
    std::vector<std::string> arguments{"run",     kScene,    "--out", (folder / "out").string(),
                                       "--quiet", "--steps", "2"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    return run_program(arguments);
  };
  std::vector<Refused> cases{
      {{"--backend", "cpu", "--route", "condensed"}, "route condensed", "inverse or factor"},
      {{"--backend", "cpu", "--route", "cg"}, "route cg", "inverse or factor"},
      {{"--backend", "cpu", "--update", "eager"}, "update eager", "update deferred or auto"},
      {{"--set", "material.upper.law=corotated", "--route", "condensed"},
       "route condensed",
       "route factor or auto"},
  };
#ifdef SUNDER_GPU
  cases.push_back(
      {{"--backend", "vulkan", "--update", "eager"}, "update eager", "update deferred"});
#endif
  for (const Refused& refused : cases) {
    const Outcome run = outcome(refused.how);
    EXPECT_EQ(run.exit_code, 4) << refused.what << "\n" << run.err;
    EXPECT_TRUE(mentions(run.err, refused.what)) << run.err;
    EXPECT_TRUE(mentions(run.err, refused.instead)) << run.err;
  }
  const Outcome moves =
      outcome({"--set", "dynamics.time_step=0.001", "--set", "material.upper.density=1e-9", "--set",
               "material.lower.density=1e-9", "--set", "material.top-frame.density=1e-9", "--set",
               "material.bottom-frame.density=1e-9", "--set", "material.upper.law=corotated"});
  EXPECT_EQ(moves.exit_code, 0) << moves.err;
  const Outcome model = outcome({"--set", "fracture.model=A"});
  EXPECT_EQ(model.exit_code, 3);
  EXPECT_TRUE(mentions(model.err, "fracture.crack = \"split\" needs model \"B\"")) << model.err;
}

}  // namespace
}  // namespace sunder::test
