// SPDX-License-Identifier: Apache-2.0
// Pictures: which faces are seen, where nodes are drawn, and what the pixels show.
#include "app/figure/figure.hpp"

#include <cairo.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "app/figure/pose.hpp"
#include "app/figure/shading.hpp"
#include "app/figure/surface.hpp"
#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::app {
namespace {

using test::parse_xml;
using test::read_file;
using test::torn_board;

/// Two tetrahedra on a common face, standing on held nodes 0, 1, 2.
Scene two_tets() {
  Scene scene;
  scene.title = "two";
  scene.mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  scene.mesh.tets = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  scene.mesh.volume_of = {0, 0};
  scene.mesh.volumes = {{"tissue", 1}};
  scene.materials["tissue"] = {5.0, 0.4, 2.0};
  scene.supports.push_back({std::vector<Index>{0, 1, 2}, Axes{}});
  return scene;
}

TEST(FaceTable, SurfaceOfWhatIsLiveAndWhatIsDestroyed) {
  const Scene scene = two_tets();
  const FaceTable faces(scene.mesh);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{0, 0}).size(), 6u);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{1, 1}).size(), 6u);
  EXPECT_EQ(faces.surface(std::vector<std::uint8_t>{0, 1}).size(), 8u);  // the common face twice
}

TEST(FaceTable, NormalsPointOutwards) {
  const Scene scene = two_tets();
  for (const BodyFace& face : FaceTable(scene.mesh).surface(std::vector<std::uint8_t>{0, 1})) {
    Vec3 centroid = Vec3::Zero();
    for (const Index node : scene.mesh.tets[face.tet]) centroid += scene.mesh.nodes[node] / 4;
    const Vec3 &a = scene.mesh.nodes[face.nodes[0]], &b = scene.mesh.nodes[face.nodes[1]],
               &c = scene.mesh.nodes[face.nodes[2]];
    Mat3 edges;
    edges << b - a, c - a, a - centroid;
    EXPECT_GT(edges.determinant(), 0);
  }
}

State displaced(const Problem& problem, const Vec3& u3, const Vec3& u4) {
  State state = undeformed(problem);
  state.displacement[3] = u3;
  state.displacement[4] = u4;
  return state;
}

TEST(Pose, TrueScaleUnlessNothingWouldBeSeen) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  const auto scale = [&](double u) {
    return pose_of(problem, plane, displaced(problem, {u, 0, 0}, {0, u, 0})).scale;
  };
  EXPECT_EQ(scale(0), 1);
  EXPECT_EQ(scale(0.1), 1);
  EXPECT_EQ(scale(0.5), 1);
  EXPECT_EQ(scale(6e-5), 1000);
  EXPECT_EQ(scale(3e-3), 20);
  EXPECT_EQ(scale(60), 0.01);
}

TEST(Pose, NodesOfDestroyedElementsAloneFollowTheirNeighbours) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  State state = displaced(problem, {0.3, 0, 0}, {1e6, 1e6, 1e6});
  state.destroyed = {0, 1};
  const Pose pose = pose_of(problem, plane, state);
  EXPECT_EQ(pose.scale, 1);
  EXPECT_LT((pose.shift[4] - Vec3(0.1, 0, 0)).norm(), 1e-12);  // mean of nodes 1, 2, 3
  EXPECT_FALSE(pose.loose_piece);
}

TEST(Pose, CutOffPiecesStayNearTheirPlace) {
  const Problem problem(two_tets());
  const BoardPlane plane = board_plane(problem.mesh(), std::nullopt);
  State state = displaced(problem, {1e6, 0, 0}, {1e6, 0, 0});
  state.destroyed = {1, 0};  // element 1 keeps two held corners: it can turn about them
  const Pose pose = pose_of(problem, plane, state);
  EXPECT_TRUE(pose.loose_piece);
  EXPECT_EQ(pose.scale, 1);
  // As a whole, a share of the body's side (1 mm) at most.
  for (const Index node : {3, 4}) EXPECT_LT((pose.shift[node] - Vec3(0.12, 0, 0)).norm(), 1e-12);
}

TEST(Shading, RedsGetDarkerAndStayInRange) {
  EXPECT_EQ(red(-1), red(0));
  EXPECT_EQ(red(2), red(1));
  int last = 3 * 256;
  for (int i = 0; i <= 20; ++i) {
    const Color c = red(i / 20.0);
    EXPECT_LT(c.r + c.g + c.b, last);
    last = c.r + c.g + c.b;
    EXPECT_GE(c.r, c.g);
  }
  EXPECT_EQ(hex({255, 0, 171}), "#ff00ab");
}

/// A decoded picture.
class Picture {
 public:
  explicit Picture(const std::filesystem::path& path)
      : surface_(cairo_image_surface_create_from_png(path.c_str())) {}
  ~Picture() { cairo_surface_destroy(surface_); }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface_); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface_); }
  /// Share of the pixels that a rule holds for.
  [[nodiscard]] double share(const std::function<bool(int r, int g, int b)>& rule) const {
    const unsigned char* data = cairo_image_surface_get_data(surface_);
    const int stride = cairo_image_surface_get_stride(surface_);
    int count = 0;
    for (int y = 0; y < height(); ++y)
      for (int x = 0; x < width(); ++x) {
        const unsigned char* p = data + y * stride + 4 * x;  // B G R A on a little-endian machine
        if (rule(p[2], p[1], p[0])) ++count;
      }
    return count / (static_cast<double>(width()) * height());
  }

 private:
  cairo_surface_t* surface_;
};

bool black(int r, int g, int b) { return r < 30 && g < 30 && b < 30; }
bool reddish(int r, int g, int b) { return r > g + 12 && r > b + 12 && std::abs(g - b) < 60; }
bool grey(int r, int g, int b) {
  return r > 160 && r < 192 && std::abs(r - g) < 8 && std::abs(g - b) < 8;
}
bool yellow(int r, int g, int b) { return r > 240 && g > 200 && b < 60; }

TEST(Figure, ShowsStressTearFrameAndInstrument) {
  const Picture picture(torn_board() / "figure.png");
  EXPECT_GT(picture.share(black), 0.02);
  EXPECT_GT(picture.share(reddish), 0.1);
  EXPECT_GT(picture.share(grey), 0.03);
  EXPECT_GT(picture.share(yellow), 0.0003);
}

TEST(Figure, IntactBoardHasNoBlack) {
  const test::TempFolder folder;
  const test::TearingBoard board(folder);
  ASSERT_EQ(
      test::run_program({"run", board.scene.string(), "--out", (folder / "o").string(), "--steps",
                         "2", "--set", "instrument.0.force=[0,-3,0]", "--set", "destroy=[]"})
          .exit_code,
      0);
  const Picture picture(folder / "o" / "figure.png");
  EXPECT_LT(picture.share(black), 0.01);  // text and the held edge
  EXPECT_GT(picture.share(grey), 0.03);
  const std::string svg = read_file(folder / "o" / "figure.svg");
  EXPECT_NE(svg.find("Displacements at true scale"), std::string::npos);
}

TEST(Figure, PngIsTheSvgAtAFixedZoom) {
  const auto svg = parse_xml(read_file(torn_board() / "figure.svg"));
  const Picture picture(torn_board() / "figure.png");
  EXPECT_EQ(picture.width(), std::ceil(1.6 * std::stod(svg.attributes.at("width"))));
  EXPECT_EQ(picture.height(), std::ceil(1.6 * std::stod(svg.attributes.at("height"))));
}

TEST(Figure, SaysWhatItShows) {
  const std::string svg = read_file(torn_board() / "figure.svg");
  const auto destroyed = test::read_json(torn_board() / "summary.json")["destroyed"].size();
  EXPECT_EQ(parse_xml(svg).child("title").text, "Board <pulled> & torn");
  for (const std::string& part :
       {std::string("Step 5 of 5, load factor 1: "), std::to_string(destroyed) + " elements of 500",
        std::string("max. shear / yield"), std::string("Black: destroyed")})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

TEST(Figure, FineMeshesStaySmallFiles) {
  const test::TempFolder folder;
  const test::TearingBoard board(folder);
  ASSERT_EQ(test::run_program({"mesh", "board", "--nx", "100", "--ny", "80", "--nz", "1", "-o",
                               (folder / "board.msh").string()})
                .exit_code,
            0);
  const test::Outcome run = test::run_program(
      {"run", board.scene.string(), "--out", (folder / "o").string(), "--steps", "1", "--set",
       "instrument.0.force=[0,-3,0]", "--set", "destroy=[]", "--set", "fracture.model=none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(std::filesystem::file_size(folder / "o" / "figure.svg"), 1'000'000u);
  EXPECT_LT(std::filesystem::file_size(folder / "o" / "index.html"), 2'500'000u);
  const Picture picture(folder / "o" / "figure.png");
  EXPECT_GT(picture.share(reddish), 0.1);
  EXPECT_GT(picture.share(grey), 0.03);
}

}  // namespace
}  // namespace sunder::app
