// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/board.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "app/input/input_support.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/same_mesh.hpp"

namespace sunder::test {
namespace {

double volume(const Mesh& mesh, const std::array<Index, 4>& tet) {
  const auto x = [&](std::size_t c) { return mesh.nodes[static_cast<std::size_t>(tet[c])]; };
  return (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6;
}

// 1 for a regular tetrahedron: 12 (3 V)^(2/3) / sum of squared edges.
double quality(const Mesh& mesh, const std::array<Index, 4>& tet) {
  double edges = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b)
      edges += (mesh.nodes[static_cast<std::size_t>(tet[a])] -
                mesh.nodes[static_cast<std::size_t>(tet[b])])
                   .squaredNorm();
  }
  return 12 * std::pow(3 * volume(mesh, tet), 2.0 / 3) / edges;
}

// Every face belongs to two tetrahedra or lies on the board's outside.
void expect_conforming(const Mesh& mesh, double thickness) {
  std::map<std::array<Index, 3>, int> faces;
  for (const auto& tet : mesh.tets) {
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      std::array<Index, 3> face{};
      for (std::size_t c = 0, i = 0; c < 4; ++c)
        if (c != left_out) face[i++] = tet[c];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  }
  const Vec3 far(50, 50, thickness);
  for (const auto& [face, count] : faces) {
    ASSERT_LE(count, 2);
    if (count == 2) continue;
    bool outside = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double plane : {0.0, far[axis]})
        outside =
            outside || std::all_of(face.begin(), face.end(), [&](Index node) {
              return std::abs(mesh.nodes[static_cast<std::size_t>(node)][axis] - plane) < 1e-9;
            });
    }
    ASSERT_TRUE(outside) << "a gap at the face of nodes " << face[0] << ' ' << face[1] << ' '
                         << face[2];
  }
}

void expect_board(const Mesh& mesh, double thickness, double least_quality) {
  ASSERT_EQ(mesh.volumes.size(), 4U);
  const char* names[] = {"bottom-frame", "lower", "upper", "top-frame"};
  const double borders[] = {0, 5, 25, 45, 50};
  double volumes[4] = {};
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(mesh.volumes[v].name, names[v]);
    EXPECT_EQ(mesh.volumes[v].tag, static_cast<int>(v) + 1);
  }
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto v = static_cast<std::size_t>(mesh.volume_of[e]);
    ASSERT_GT(volume(mesh, mesh.tets[e]), 0.0) << e;
    ASSERT_GT(quality(mesh, mesh.tets[e]), least_quality) << e;
    volumes[v] += volume(mesh, mesh.tets[e]);
    for (const Index node : mesh.tets[e]) {
      const double y = mesh.nodes[static_cast<std::size_t>(node)][1];
      ASSERT_TRUE(y >= borders[v] - 1e-9 && y <= borders[v + 1] + 1e-9) << e;
    }
  }
  for (std::size_t v = 0; v < 4; ++v) {
    const double exact = 50 * thickness * (borders[v + 1] - borders[v]);
    EXPECT_NEAR(volumes[v], exact, 1e-9 * exact);
  }
  expect_conforming(mesh, thickness);
}

TEST(Board, StructuredByCells) {
  app::BoardOptions options;
  options.nx = 7;
  options.ny = 11;
  options.nz = 2;
  options.thickness = 2.5;
  app::BoardReport report;
  const Mesh mesh = app::make_board(options, &report);
  EXPECT_EQ(mesh.tet_count(), 5 * 7 * 11 * 2);
  EXPECT_EQ(mesh.node_count(), 8 * 12 * 3);
  EXPECT_EQ(report.tets, mesh.tet_count());
  EXPECT_EQ(report.nodes, mesh.node_count());
  EXPECT_EQ(report.nx, 7);
  // Cells of 7.1 x 4.5 x 1.25 mm: the corner tetrahedra's quality, by the formula of quality().
  expect_board(mesh, 2.5, 0.3);
}

TEST(Board, FewestRows) {
  app::BoardOptions options;
  options.nx = 1;
  options.ny = 4;
  options.nz = 1;
  expect_board(app::make_board(options), 2.0, 0.0);
}

TEST(Board, NearestCount) {
  for (const long long tets : {500LL, 1954LL, 2000LL, 8000LL, 30'000LL, 120'000LL, 1'000'000LL}) {
    app::BoardOptions options;
    options.tets = tets;
    options.thickness = 2.5;
    app::BoardReport report;
    const Mesh mesh = app::make_board(options, &report);
    // The product of three whole numbers with near sides: some 2 % apart at 2000.
    EXPECT_NEAR(static_cast<double>(mesh.tet_count()) / static_cast<double>(tets), 1.0, 0.02);
    const double ratio = static_cast<double>(report.nx) / report.ny;
    EXPECT_TRUE(ratio >= 0.8 && ratio <= 1.25) << tets << ": " << report.nx << " x " << report.ny;
    if (tets <= 30'000) expect_board(mesh, 2.5, 0.3);
  }
}

TEST(Board, UnstructuredThroughGmsh) {
  for (const long long tets : {500LL, 5000LL}) {
    app::BoardOptions options;
    options.tets = tets;
    options.unstructured = true;
    const Mesh mesh = app::make_board(options);
    EXPECT_NEAR(static_cast<double>(mesh.tet_count()) / static_cast<double>(tets), 1.0, 0.03);
    expect_board(mesh, 2.0, 0.05);
    expect_same_mesh(mesh, app::make_board(options));  // no luck involved
  }
}

TEST(Board, FilesReadBack) {
  const TemporaryFolder folder;
  app::BoardOptions options;
  options.tets = 2000;
  const Mesh mesh = app::make_board(options);
  for (const bool ascii : {false, true}) {
    options.ascii = ascii;
    const app::BoardReport report = app::write_board(options, folder.file("board.msh"));
    EXPECT_EQ(report.tets, 2000);
    expect_same_mesh(app::import_mesh(folder.file("board.msh")), mesh);
  }
  options.ascii = false;
  options.unstructured = true;
  static_cast<void>(app::write_board(options, folder.file("free.msh")));
  expect_same_mesh(app::import_mesh(folder.file("free.msh")), app::make_board(options));
  static_cast<void>(app::write_board(options, folder.file("free.vtk")));
  EXPECT_EQ(app::import_mesh(folder.file("free.vtk")).tets,
            app::import_mesh(folder.file("free.msh")).tets);
  // Nothing but the files asked for.
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("")))
    files += entry.is_regular_file() ? 1U : 0U;
  EXPECT_EQ(files, 3U);
}

TEST(Board, SaysWhatIsAllowed) {
  const auto expect_usage = [](const app::BoardOptions& options, const std::string& file,
                               const std::vector<std::string>& parts) {
    try {
      static_cast<void>(app::write_board(options, file));
      FAIL() << "no error";
    } catch (const UsageError& error) {
      EXPECT_EQ(error.exit_code(), 2);
      for (const std::string& part : parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(file));
  };
  const TemporaryFolder folder;
  const std::string file = folder.file("b.msh");
  app::BoardOptions options;
  options.nx = 0;
  expect_usage(options, file, {"--nx is 0", "1 to 10000"});
  options = {};
  options.ny = 3;
  expect_usage(options, file, {"--ny is 3", "4 to"});
  options = {};
  options.nz = -1;
  expect_usage(options, file, {"--nz is -1"});
  options = {};
  options.nx = options.ny = options.nz = 10'000;
  expect_usage(options, file, {"5000000000000", "50000000"});
  options = {};
  options.tets = 99;
  expect_usage(options, file, {"--tets is 99", "100 to"});
  options.tets = 1'000'000'000'000;
  expect_usage(options, file, {"--tets is 1000000000000"});
  options.tets = 1000;
  options.nx = 3;
  expect_usage(options, file, {"--tets", "--nx"});
  options = {};
  options.unstructured = true;
  expect_usage(options, file, {"--unstructured needs --tets"});
  for (const double thickness : {0.0, -1.0, 51.0, std::nan(""), 1.0 / 0.0}) {
    options = {};
    options.thickness = thickness;
    expect_usage(options, file, {"--thickness", "0.1 to 50 mm"});
  }
  expect_usage({}, folder.file("b.stl"), {".stl", "\".msh\""});
  expect_usage({}, folder.file("b"), {"extension \"\""});
  options = {};
  options.ascii = true;
  expect_usage(options, folder.file("b.vtk"), {"--ascii", ".msh", "b.vtk"});
}

}  // namespace
}  // namespace sunder::test
