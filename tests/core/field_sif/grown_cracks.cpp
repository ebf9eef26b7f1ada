// SPDX-License-Identifier: Apache-2.0
#include "core/field_sif/grown_cracks.hpp"

#include <cmath>
#include <numbers>

#include "core/field_sif/cracked_board.hpp"

namespace sunder::test {
namespace {

constexpr double kSeed = 1e-6;  // [mm] half length of an internal crack before it grows

Vec2 direction(double radians) { return {std::cos(radians), std::sin(radians)}; }

void seed(CrackedBody& plate, const Vec2& middle, double radians) {
  const Vec2 d = direction(radians);
  plate.set_crack(CrackKind::internal, middle - kSeed * d, middle + kSeed * d, {});
}

Support hold(const Mesh& mesh, const Vec3& p, int axes) {
  Index best = 0;
  for (Index n = 1; n < mesh.node_count(); ++n)
    if ((mesh.nodes[n] - p).norm() < (mesh.nodes[best] - p).norm()) best = n;
  return {std::vector<Index>{best}, Axes{static_cast<std::uint8_t>(axes)}};
}

}  // namespace

CrackedBody square_plate(double fine, double half) {
  const auto lines = graded_lines(1.0, fine, half, 1.15);
  Scene scene;
  scene.mesh = grid_mesh({lines, lines, even_lines(1, 1.0)});
  scene.materials["board"] = {5, 0.3, 2.0};
  scene.fracture.alpha = 1e-9;
  scene.supports = {hold(scene.mesh, Vec3(half, -half, 0), 7),
                    hold(scene.mesh, Vec3(half, half, 0), 5),
                    hold(scene.mesh, Vec3(-half, -half, 0), 4)};
  return CrackedBody(std::move(scene));
}

void grow_inclined(CrackedBody& plate, double degrees, double half_length) {
  const double angle = degrees * std::numbers::pi / 180;
  // Off the grid's symmetry lines: the general case.
  seed(plate, {0.13, 0.07}, angle);
  plate.grow(1, direction(angle), half_length);
  plate.grow(0, -direction(angle), half_length);
}

void grow_kinked(CrackedBody& plate, double half_length, double degrees, double branch) {
  grow_inclined(plate, 0, half_length);
  plate.grow(1, direction(degrees * std::numbers::pi / 180), branch);
}

void grow_arc(CrackedBody& plate, double radius, double arc) {
  seed(plate, {0.13, 0.07}, 0);
  const double step = 1;  // [mm] about h
  for (std::size_t tip : {1u, 0u}) {
    const double begin = plate.crack().length;
    const double sense = tip == 1 ? 1 : -1;
    for (double s = 0; s < arc - step / 2; s = plate.crack().length - begin) {
      const double ahead = std::min(step, arc - s);
      plate.grow(tip, sense * direction(-sense * (s + ahead / 2) / radius), ahead);
    }
  }
}

ArcIntensity arc_intensity(double radius, double half_angle) {
  const double s2 = std::pow(std::sin(half_angle / 2), 2), c2 = 1 - s2;
  const double scale = std::sqrt(std::numbers::pi * radius * std::sin(half_angle)) / 2;
  const double mean = (1 - s2 * c2) / (1 + s2);
  return {scale * (mean * std::cos(half_angle / 2) + std::cos(1.5 * half_angle)),
          scale * (mean * std::sin(half_angle / 2) + std::sin(1.5 * half_angle))};
}

}  // namespace sunder::test
