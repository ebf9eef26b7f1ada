// SPDX-License-Identifier: Apache-2.0
#include "app/input/mesh_scene.hpp"

#include <algorithm>
#include <sstream>

#include "app/input/mesh_import.hpp"
#include "app/input/toml.hpp"

namespace sunder::app {
namespace {

constexpr double kPulled = 0.6;  // of the body's length
constexpr int kSteps = 120;

/// As in scenes/finite/liver.toml, whose comments say what the numbers stand for.
toml::table liver() {
  return toml::table{
      {"young", 0.0125}, {"poisson", 0.45}, {"yield", 0.0022}, {"law", "corotated"}};
}

struct Extent {
  explicit Extent(const Mesh& mesh) {
    for (const Vec3& x : mesh.nodes) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    (high - low).maxCoeff(&axis);
  }
  [[nodiscard]] double length() const { return high[axis] - low[axis]; }

  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  int axis = 0;  // the longest
};

toml::array array_of(const Vec3& x) { return toml::array{x.x(), x.y(), x.z()}; }

/// An end of the body that has a fair share of its nodes: by one node alone an element is pulled
/// out, and no body is held.
toml::array end_box(const Mesh& mesh, const Extent& of, bool far) {
  const auto wanted = static_cast<long>(std::max<std::size_t>(4, mesh.nodes.size() / 100));
  double depth = 0;
  for (const double share : {0.05, 0.1, 0.2, 0.3}) {
    depth = share * of.length();
    const auto in = std::ranges::count_if(mesh.nodes, [&](const Vec3& x) {
      return far ? x[of.axis] >= of.high[of.axis] - depth : x[of.axis] <= of.low[of.axis] + depth;
    });
    if (in >= wanted) break;
  }
  const Vec3 margin = Vec3::Constant(0.01 * of.length());
  Vec3 low = of.low - margin, high = of.high + margin;
  if (far) {
    low[of.axis] = of.high[of.axis] - depth;
  } else {
    high[of.axis] = of.low[of.axis] + depth;
  }
  return toml::array{array_of(low), array_of(high)};
}

}  // namespace

std::string mesh_scene_text(const std::filesystem::path& path) {
  const Mesh mesh = import_mesh(path);
  const Extent extent(mesh);
  toml::table materials;
  for (const auto& volume : mesh.volumes) materials.insert(volume.name, liver());
  Vec3 pulled = Vec3::Zero();
  pulled[extent.axis] = kPulled * extent.length();
  const toml::table forceps{{"name", "forceps"},
                            {"kind", "expansion"},
                            {"box", end_box(mesh, extent, true)},
                            {"displacement", array_of(pulled)},
                            {"rigid", true},
                            {"ramp", toml::array{0.0, 1.0}}};
  const toml::table scene{
      {"title", path.stem().string()},
      {"mesh", path.filename().string()},
      {"material", std::move(materials)},
      {"fixed", toml::array{toml::table{{"box", end_box(mesh, extent, false)}}}},
      {"instrument", toml::array{forceps}},
      {"fracture", toml::table{{"model", "A"}}},
      {"time", toml::table{{"steps", kSteps}}}};
  std::ostringstream out;
  out << toml::toml_formatter(scene) << "\n";
  return out.str();
}

}  // namespace sunder::app
