// SPDX-License-Identifier: Apache-2.0
// Pictures of a simulation on the device that draws, by places, normals and colours that it leaves
// there: the host writes none of them, and the pictures are those of what it writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "app/view/colours.hpp"
#include "app/view/painter.hpp"
#include "app/view/session.hpp"
#include "core/frame/strip.hpp"
#include "sunder/backends.hpp"

namespace sunder::test {
namespace {

using namespace app;

constexpr PictureSize kPicture{480, 360};

struct Shares {
  explicit Shares(Scene scene = strip(1e9, 3, 40)) {
    scene.live = true;
    scene.solver.backend = "vulkan";
    problem = std::make_shared<const Problem>(std::move(scene));
    session.emplace(
        problem, [this] { return make(); }, true, kPicture, points);
    session->look().camera = {30, 20, 1};
    session->look().colour = input::Colour{Field::yield, std::nullopt};
    on_device.emplace(device, kPicture);
    by_host.emplace(device, kPicture);
  }
  std::unique_ptr<Backend> make() const {
    points->leave();
    auto backend = create_backend_on(problem, needs_of(*problem), device.lend()).backend;
    points->begin(device);
    return backend;
  }
  std::shared_ptr<const Shown> show() { return session->show(on_device->version()); }
  std::vector<std::uint8_t> draw(Painter& painter, const std::shared_ptr<const Shown>& shown) {
    painter.draw(shown, session->look(), session->camera());
    return painter.pixels().rgba;
  }
  /// The same frame with places and normals that the host writes.
  static std::shared_ptr<const Shown> from_host(const Shown& shown) {
    auto copy = std::make_shared<Shown>(shown);
    copy->points = nullptr;
    copy->normals = normals_of(copy->triangles, copy->places);
    copy->since = copy->version;
    return copy;
  }
  void expect_picture_of_host() {
    const auto shown = session->show(0);
    ASSERT_TRUE(shown->points);
    const auto there = draw(*on_device, shown), here = draw(*by_host, from_host(*shown));
    ASSERT_EQ(there.size(), here.size());
    std::size_t far = 0;
    for (std::size_t b = 0; b < there.size(); ++b) far += std::abs(there[b] - here[b]) > 1;
    EXPECT_LT(far, there.size() / 1000);  // a rim whose sample falls otherwise
  }

  mutable view::Device device;
  std::shared_ptr<view::SharedPoints> points = std::make_shared<view::SharedPoints>();
  std::shared_ptr<const Problem> problem;
  std::optional<Session> session;
  std::optional<Painter> on_device, by_host;
};

TEST(SharedPoints, PicturesAreThoseOfPlacesFromTheHost) {
  Shares shares;
  EXPECT_FALSE(shares.show()->points) << "there is no step yet";
  for (int i = 0; i < 3; ++i) {
    shares.session->step();
    shares.expect_picture_of_host();
  }
  shares.session->hand().remove(std::vector<Index>{100, 101, 102});
  shares.expect_picture_of_host();
  shares.session->step();
  shares.expect_picture_of_host();
  shares.session->hand().undo(1);  // which takes a new backend
  shares.expect_picture_of_host();
  shares.session->hand().redo(1);
  shares.expect_picture_of_host();
}

// By each measure of strength, on which the device's stress depends.
TEST(SharedPoints, ColoursAreThoseOfValuesFromTheHost) {
  for (const YieldMeasure measure :
       {YieldMeasure::max_shear, YieldMeasure::tresca, YieldMeasure::principal}) {
    Scene scene = strip(1e3, 3, 40);
    scene.fracture.yield_measure = measure;
    if (measure == YieldMeasure::principal) scene.fracture.model = FractureModel::p;
    Shares shares(std::move(scene));
    shares.session->step();
    for (const Field field : {Field::stress, Field::yield, Field::strain, Field::displacement}) {
      // The scale's end in the middle of what there is, so that every shade is there.
      const Paint all = paint(*shares.problem, shares.show()->state, shares.show()->triangles,
                              {field, std::nullopt});
      std::vector<float> values = all.values;
      std::ranges::sort(values);
      ASSERT_GT(values[values.size() / 2], 0);
      shares.session->look().colour = input::Colour{field, values[values.size() / 2]};
      SCOPED_TRACE(static_cast<int>(field));
      shares.expect_picture_of_host();
    }
  }
}

TEST(SharedPoints, AnotherFieldCostsNoByteOfTheHost) {
  Shares shares;
  shares.session->step();
  const auto shown = shares.show();
  const auto ratios = shares.draw(*shares.on_device, shown);
  const std::uint64_t at = shares.on_device->renderer().uploaded();
  shares.session->look().colour = input::Colour{Field::displacement, std::nullopt};
  EXPECT_NE(shares.draw(*shares.on_device, shown), ratios);
  EXPECT_EQ(shares.on_device->renderer().uploaded(), at);
}

TEST(SharedPoints, TheHostWritesNothingOfAFrameThatOnlyMoves) {
  Shares shares;
  shares.session->step();
  static_cast<void>(shares.draw(*shares.on_device, shares.show()));
  const auto shown = shares.show();
  static_cast<void>(shares.draw(*shares.by_host, shares.from_host(*shares.session->show(0))));
  for (int i = 0; i < 3; ++i) {
    const auto before = shares.draw(*shares.on_device, shares.show());
    shares.session->step();
    const std::uint64_t at = shares.on_device->renderer().uploaded();
    const std::uint64_t host_at = shares.by_host->renderer().uploaded();
    const auto moved = shares.show();
    EXPECT_NE(shares.draw(*shares.on_device, moved), before);
    EXPECT_EQ(shares.on_device->renderer().uploaded(), at);
    static_cast<void>(shares.draw(*shares.by_host, shares.from_host(*moved)));
    const std::uint64_t by_host = shares.by_host->renderer().uploaded() - host_at;
    EXPECT_GT(by_host, 32 * moved->places.size());  // and values
    EXPECT_LE(by_host, 32 * moved->places.size() + 4 * moved->triangles.size());
  }
}

TEST(SharedPoints, AFrameStaysAsItWasWhileStepsGoOn) {
  Shares shares;
  shares.session->step();
  const auto held = shares.session->show(0);
  const auto picture = shares.draw(*shares.on_device, held);
  for (int i = 0; i < 4; ++i) {
    shares.session->step();
    const auto later = shares.session->show(0);
    ASSERT_TRUE(later->points);
    EXPECT_NE(later->points, held->points);
    EXPECT_NE(shares.draw(*shares.by_host, later), picture);
    EXPECT_EQ(shares.draw(*shares.on_device, held), picture);
  }
}

TEST(SharedPoints, ACutOffPieceIsDrawnFromTheHost) {
  Shares shares;
  shares.session->step();
  std::vector<Index> row;  // all cells of the fourth row: what lies below comes off
  for (Index e = 72; e < 96; ++e) row.push_back(e);
  shares.session->hand().remove(row);
  shares.session->step();
  const auto shown = shares.session->show(0);
  EXPECT_FALSE(shown->points);
  EXPECT_EQ(shares.draw(*shares.on_device, shown),
            shares.draw(*shares.by_host, shares.from_host(*shown)));
  shares.session->hand().undo(1);
  EXPECT_TRUE(shares.session->show(0)->points);
}

}  // namespace
}  // namespace sunder::test
