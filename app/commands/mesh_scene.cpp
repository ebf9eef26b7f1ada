// SPDX-License-Identifier: Apache-2.0
#include "app/commands/mesh_scene.hpp"

#include <sstream>

#include "app/input/mesh_import.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

// Of soft organs (docs/tissues.md): E, and the maximum shear stress of a strain of some 40 %.
constexpr const char* kTissue = "{ young = 0.05, poisson = 0.45, yield = 0.01 }";
// Held: so much of the length at its lower end.
constexpr double kHeld = 0.05;

/// As a quoted key or string of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    constexpr char kDigits[] = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      out += std::string("\\u00") + kDigits[byte / 16] + kDigits[byte % 16];
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string vector_of(const Vec3& v) {
  return "[" + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + "]";
}

}  // namespace

std::string scene_of_mesh(const Mesh& mesh, const std::filesystem::path& file) {
  Vec3 low = mesh.nodes.front(), high = low;
  for (const Vec3& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vec3 size = high - low;
  Eigen::Index axis = 0;
  const double length = size.maxCoeff(&axis);
  Vec3 top = high + 1e-6 * size;
  top[axis] = low[axis] + kHeld * length;
  std::ostringstream out;
  out << "title = " << quoted(file.stem().string()) << "\nmesh = " << quoted(file.string())
      << "\n[material]\n";
  for (const NamedVolume& volume : mesh.volumes) {
    out << quoted(volume.name) << " = " << kTissue << "\n";
  }
  out << "[[fixed]]\nbox = [" << vector_of(low - 1e-6 * size) << ", " << vector_of(top)
      << "]\n[fracture]\nmodel = \"A\"\nmax_events = 8\n[time]\nsteps = 1000000\n";
  return out.str();
}

std::string scene_of_mesh(const std::filesystem::path& file) {
  return scene_of_mesh(import_mesh(file),
                       std::filesystem::weakly_canonical(std::filesystem::absolute(file)));
}

}  // namespace sunder::app
