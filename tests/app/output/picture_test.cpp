// SPDX-License-Identifier: Apache-2.0
// What the pixels of a figure show.
#include <cairo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::test {
namespace {

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
  EXPECT_LT(picture.share(black), 0.02);  // text, the held edge, lips, the inset
  EXPECT_GT(picture.share(reddish), 0.1);
  EXPECT_GT(picture.share(grey), 0.03);
  EXPECT_GT(picture.share(yellow), 0.0003);
}

TEST(Figure, IntactBoardHasNoBlack) {
  const TempFolder folder;
  const TearingBoard board(folder);
  ASSERT_EQ(run_program({"run", board.scene.string(), "--out", (folder / "o").string(), "--steps",
                         "2", "--set", "instrument.0.force=[0,-3,0]", "--set", "destroy=[]"})
                .exit_code,
            0);
  const Picture picture(folder / "o" / "figure.png");
  EXPECT_LT(picture.share(black), 0.01);  // text and the held edge
  EXPECT_GT(picture.share(grey), 0.03);
  const std::string svg = read_file(folder / "o" / "figure.svg");
  EXPECT_NE(svg.find("Displacement × 1: true scale"), std::string::npos);
  for (const char* part : {"class=\"lip\"", "class=\"destroyed\"", "A tear is a gap"})
    EXPECT_EQ(svg.find(part), std::string::npos) << part;
}

TEST(Figure, PngIsTheSvgAtAFixedZoom) {
  const auto svg = parse_xml(read_file(torn_board() / "figure.svg"));
  const Picture picture(torn_board() / "figure.png");
  EXPECT_EQ(picture.width(), std::ceil(1.6 * std::stod(svg.attributes.at("width"))));
  EXPECT_EQ(picture.height(), std::ceil(1.6 * std::stod(svg.attributes.at("height"))));
}

TEST(Figure, SaysWhatItShows) {
  const std::string svg = read_file(torn_board() / "figure.svg");
  const auto destroyed = read_json(torn_board() / "summary.json")["destroyed"].size();
  EXPECT_EQ(parse_xml(svg).child("title").text, "Board <pulled> & torn");
  for (const std::string& part :
       {std::string("Step 5 of 5, load factor 1: "), std::to_string(destroyed) + " elements of 500",
        std::string("max. shear / yield"), std::string("A tear is a gap"),
        std::string("<path class=\"lip\""), std::string("<svg class=\"destroyed\"")})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
}

TEST(Figure, FineMeshesStaySmallFiles) {
  const TempFolder folder;
  const TearingBoard board(folder);
  ASSERT_EQ(run_program({"mesh", "board", "--nx", "100", "--ny", "80", "--nz", "1", "-o",
                         (folder / "board.msh").string()})
                .exit_code,
            0);
  const Outcome run = run_program({"run", board.scene.string(), "--out", (folder / "o").string(),
                                   "--steps", "1", "--set", "instrument.0.force=[0,-3,0]", "--set",
                                   "destroy=[]", "--set", "fracture.model=none"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(std::filesystem::file_size(folder / "o" / "figure.svg"), 1'000'000u);
  EXPECT_LT(std::filesystem::file_size(folder / "o" / "index.html"), 2'500'000u);
  const Picture picture(folder / "o" / "figure.png");
  EXPECT_GT(picture.share(reddish), 0.1);
  EXPECT_GT(picture.share(grey), 0.03);
}

}  // namespace
}  // namespace sunder::test
