// SPDX-License-Identifier: Apache-2.0
// VTU and PVD files read back with another reader.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::test {
namespace {

using Names = std::vector<std::string>;

struct Grid {
  explicit Grid(const std::filesystem::path& path)
      : file(parse_xml(read_file(path))),
        grid(file.child("UnstructuredGrid")),
        piece(grid.child("Piece")) {}
  Grid(const Grid&) = delete;

  template <class T>
  [[nodiscard]] std::vector<T> cells(const std::string& name) const {
    return values_of<T>(piece.child("CellData").child("DataArray", name));
  }

  XmlElement file;
  const XmlElement &grid, &piece;
};

const Grid& torn() {
  static const Grid grid(torn_board() / "result.vtu");
  return grid;
}

TEST(Vtu, SaysWhatItIs) {
  EXPECT_EQ(torn().file.name, "VTKFile");
  EXPECT_EQ(torn().file.attributes.at("type"), "UnstructuredGrid");
  EXPECT_EQ(torn().file.attributes.at("byte_order"), "LittleEndian");
  EXPECT_EQ(torn().file.attributes.at("header_type"), "UInt64");
  EXPECT_EQ(torn().piece.attributes.at("NumberOfPoints"), "242");
  EXPECT_EQ(torn().piece.attributes.at("NumberOfCells"), "500");
}

TEST(Vtu, HasTheDocumentedArrays) {
  EXPECT_EQ(torn().piece.child("PointData").array_names(), Names{"displacement"});
  EXPECT_EQ(torn().piece.child("CellData").array_names(),
            (Names{"stress", "max_shear", "yield_ratio", "destroyed", "volume"}));
  const XmlElement& stress = torn().piece.child("CellData").child("DataArray", "stress");
  EXPECT_EQ(stress.attributes.at("type"), "Float64");
  EXPECT_EQ(stress.attributes.at("NumberOfComponents"), "6");
  EXPECT_EQ(torn().cells<double>("stress").size(), 6u * 500);
  for (const char* name : {"max_shear", "yield_ratio"})
    EXPECT_EQ(torn().cells<double>(name).size(), 500u) << name;
}

TEST(Vtu, NamesTheVolumesTags) {
  const XmlElement& field = torn().grid.child("FieldData");
  EXPECT_EQ(field.array_names(), (Names{"bottom-frame", "lower", "upper", "top-frame"}));
  std::map<std::int32_t, int> cells_of_tag;
  for (const std::int32_t tag : torn().cells<std::int32_t>("volume")) ++cells_of_tag[tag];
  // 10 x 10 x 1 cells of 5 mm, five tetrahedra each; frames are one cell high.
  for (const auto& [name, cells] : std::map<std::string, int>{
           {"bottom-frame", 50}, {"lower", 200}, {"upper", 200}, {"top-frame", 50}}) {
    const auto tag = values_of<std::int32_t>(field.child("DataArray", name));
    ASSERT_EQ(tag.size(), 1u);
    EXPECT_EQ(cells_of_tag[tag[0]], cells) << name;
  }
}

TEST(Vtu, CellsArePositiveTetrahedraOfTheBoard) {
  const auto points = values_of<double>(torn().piece.child("Points").child("DataArray"));
  const XmlElement& cells = torn().piece.child("Cells");
  const auto nodes = values_of<std::int32_t>(cells.child("DataArray", "connectivity"));
  const auto offsets = values_of<std::int64_t>(cells.child("DataArray", "offsets"));
  const auto types = values_of<std::uint8_t>(cells.child("DataArray", "types"));
  ASSERT_EQ(points.size(), 3u * 242);
  ASSERT_EQ(nodes.size(), 4u * 500);
  double volume = 0;
  for (std::size_t e = 0; e < 500; ++e) {
    EXPECT_EQ(offsets[e], static_cast<std::int64_t>(4 * e + 4));
    EXPECT_EQ(types[e], 10);
    double edge[3][3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        edge[k][i] = points[3 * static_cast<std::size_t>(nodes[4 * e + k + 1]) + i] -
                     points[3 * static_cast<std::size_t>(nodes[4 * e]) + i];
    const auto& [a, b, c] = edge;
    const double six = (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
                       (a[0] * b[1] - a[1] * b[0]) * c[2];
    EXPECT_GT(six, 0) << "element " << e;
    volume += six / 6;
  }
  EXPECT_NEAR(volume, 50 * 50 * 2, 1e-9);
}

TEST(Vtu, FieldsAgreeWithEachOther) {
  const auto stress = torn().cells<double>("stress");
  const auto shear = torn().cells<double>("max_shear");
  const auto ratio = torn().cells<double>("yield_ratio");
  const auto destroyed = torn().cells<std::uint8_t>("destroyed");
  const auto volume = torn().cells<std::int32_t>("volume");
  const double yield[] = {0, 0, 4, 2, 0};  // by tag
  for (std::size_t e = 0; e < 500; ++e) {
    const double y = yield[volume[e]];
    if (destroyed[e] || y == 0) {
      EXPECT_EQ(ratio[e], 0) << e;
    } else {
      EXPECT_DOUBLE_EQ(ratio[e], shear[e] / y) << e;
    }
    // (s1 - s3)/2 lies between 1/2 and 1/sqrt(3) of the von Mises stress: a check by invariants.
    const double* s = &stress[6 * e];
    const double mises =
        std::sqrt(0.5 * ((s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
                         (s[2] - s[0]) * (s[2] - s[0])) +
                  3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
    EXPECT_GE(shear[e], mises / 2 * (1 - 1e-9)) << e;
    EXPECT_LE(shear[e], mises / std::sqrt(3.0) * (1 + 1e-9)) << e;
    EXPECT_TRUE(!destroyed[e] || shear[e] < 0.1)
        << "alpha times the strain's stress, element " << e;
  }
}

TEST(Vtu, DestroyedCellsAreThoseOfTheSummary) {
  const auto destroyed = torn().cells<std::uint8_t>("destroyed");
  const auto summary = read_json(torn_board() / "summary.json");
  EXPECT_EQ(std::accumulate(destroyed.begin(), destroyed.end(), 0u), summary["destroyed"].size());
  for (const auto& id : summary["destroyed"]) EXPECT_EQ(destroyed[id.get<std::size_t>()], 1);
}

TEST(Vtu, SupportsDoNotMove) {
  const auto points = values_of<double>(torn().piece.child("Points").child("DataArray"));
  const auto u = values_of<double>(torn().piece.child("PointData").child("DataArray"));
  int held = 0;
  for (std::size_t n = 0; n < 242; ++n) {
    if (points[3 * n + 1] != 50) continue;
    ++held;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(u[3 * n + i], 0);
  }
  EXPECT_EQ(held, 22);
}

TEST(Vtu, SnapshotShowsTheFirstEventThatReachedItsCount) {
  const auto events = read_csv(torn_board() / "events.csv");
  for (const std::size_t wanted : {3u, 10u}) {
    std::size_t reached = wanted;  // rows up to the end of the event of row `wanted`
    while (reached + 1 < events.size() && events[reached + 1][1] == events[wanted][1]) ++reached;
    const Grid grid(torn_board() / ("snapshot_" + std::to_string(wanted) + ".vtu"));
    const auto destroyed = grid.cells<std::uint8_t>("destroyed");
    EXPECT_EQ(std::accumulate(destroyed.begin(), destroyed.end(), 0u), reached);
    for (std::size_t row = 1; row <= reached; ++row)
      EXPECT_EQ(destroyed[std::stoul(events[row][2])], 1);
  }
}

TEST(Vtu, LastOfTheSeriesIsTheResult) {
  EXPECT_EQ(read_file(torn_board() / "result_0004.vtu"), read_file(torn_board() / "result.vtu"));
  const XmlElement pvd = parse_xml(read_file(torn_board() / "series.pvd"));
  EXPECT_EQ(pvd.attributes.at("type"), "Collection");
  const auto& entries = pvd.child("Collection").children;
  ASSERT_EQ(entries.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(entries[i].attributes.at("file"), "result_000" + std::to_string(i) + ".vtu");
    EXPECT_DOUBLE_EQ(std::stod(entries[i].attributes.at("timestep")),
                     static_cast<double>(i + 1) / 5);
  }
}

TEST(Vtu, LeavesOutFieldsThatWereNotAskedFor) {
  const TempFolder folder;
  const TearingBoard board(folder);
  const auto run =
      run_program({"run", board.scene.string(), "--out", (folder / "o").string(), "--steps", "2",
                   "--set", "output.fields=[]", "--set", "fracture.model=none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Grid grid(folder / "o" / "result.vtu");
  EXPECT_EQ(grid.piece.child("PointData").children.size(), 0u);
  EXPECT_EQ(grid.piece.child("CellData").array_names(), (Names{"destroyed", "volume"}));
}

}  // namespace
}  // namespace sunder::test
