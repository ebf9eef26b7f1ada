// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/gmsh_board.hpp"

#include <gmsh.h>

#include <cmath>

#include "app/input/child_process.hpp"
#include "app/input/gmsh_reader.hpp"
#include "app/mesh_board/structured_board.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

namespace geo = gmsh::model::geo;

// Four boxes, one above the other, that share their faces.
void build_geometry(double thickness, double size) {
  gmsh::clear();
  std::vector<int> left, right, across;
  for (const double y : kBoardLayers) {
    left.push_back(geo::addPoint(0, y, 0, size));
    right.push_back(geo::addPoint(kBoardSide, y, 0, size));
    across.push_back(geo::addLine(left.back(), right.back()));
  }
  const std::vector<NamedVolume> volumes = board_volumes();
  std::vector<int> solids;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    const int up_left = geo::addLine(left[v], left[v + 1]);
    const int up_right = geo::addLine(right[v], right[v + 1]);
    const int loop = geo::addCurveLoop({across[v], up_right, -across[v + 1], -up_left});
    const int face = geo::addPlaneSurface({loop});
    gmsh::vectorpair extruded;
    geo::extrude({{2, face}}, 0, 0, thickness, extruded);
    for (const auto& [dimension, tag] : extruded) {
      if (dimension == 3) solids.push_back(tag);
    }
  }
  geo::removeAllDuplicates();
  geo::synchronize();
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    gmsh::model::addPhysicalGroup(3, {solids.at(v)}, volumes[v].tag);
    gmsh::model::setPhysicalName(3, volumes[v].tag, volumes[v].name);
  }
}

double count_tets() {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> tags, nodes;
  gmsh::model::mesh::getElements(types, tags, nodes, 3);
  return tags.empty() ? 0.0 : static_cast<double>(tags.front().size());
}

double mesh_with_size(double thickness, double size) {
  build_geometry(thickness, size);
  gmsh::option::setNumber("Mesh.CharacteristicLengthMin", size);
  gmsh::option::setNumber("Mesh.CharacteristicLengthMax", size);
  gmsh::model::mesh::generate(3);
  return count_tets();
}

// Element size -> count falls like size^-3, or size^-2 once one layer fills the thickness. A small
// mesh calibrates the power law before the full ones.
void reach_count(double tets, double thickness) {
  double size = std::cbrt(8.0 * kBoardSide * kBoardSide * thickness / tets);
  double best_size = size, best_miss = 1e300, last_size = 0;
  constexpr int kMostRounds = 12;
  constexpr double kCloseEnough = 0.03;
  const double calibration = std::max(2000.0, tets / 16);
  if (calibration < tets / 4) {
    const double coarse = size * std::cbrt(tets / calibration);
    size = coarse * std::cbrt(mesh_with_size(thickness, coarse) / tets);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    const double count = mesh_with_size(thickness, size);
    last_size = size;
    const double miss = std::abs(count / tets - 1);
    if (miss < best_miss) {
      best_miss = miss;
      best_size = size;
    }
    if (miss <= kCloseEnough) break;
    const double power = size > thickness ? 0.5 : 1.0 / 3;
    // Half steps later on: near one layer the count jumps with the size.
    const double damping = round < 4 ? 1.0 : 0.5;
    size *= std::pow(std::max(count, 1.0) / tets, power * damping);
  }
  if (last_size != best_size) mesh_with_size(thickness, best_size);
}

std::string mesh_to_bytes(double tets, double thickness) {
  try {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 1);
    gmsh::option::setNumber("General.Verbosity", 2);  // errors and warnings
    gmsh::option::setNumber("Mesh.RandomSeed", 1);
    gmsh::option::setNumber("Mesh.Algorithm", 5);    // Delaunay in the plane ...
    gmsh::option::setNumber("Mesh.Algorithm3D", 1);  // ... and in space
    gmsh::option::setNumber("Mesh.CharacteristicLengthExtendFromBoundary", 0);
    reach_count(tets, thickness);
    return "M" + to_bytes(read_model());
  } catch (const std::string& message) {
    return "E" + message;
  }
}

// The child's answer behind its first byte; 'E' means that gmsh said no.
std::string answer(const ChildOutcome& outcome, const std::string& task) {
  if (outcome.end != ChildOutcome::End::done || outcome.result.empty())
    throw Error(1, "gmsh failed to " + task);
  if (outcome.result[0] == 'E')
    throw Error(1, "gmsh failed to " + task + ": " + outcome.result.substr(1));
  return outcome.result.substr(1);
}

}  // namespace

Mesh unstructured_board(long long tets, double thickness) {
  ChildLimits limits;
  limits.timeout = std::chrono::milliseconds(120'000 + tets);  // some 10^5 tetrahedra a second
  limits.memory_bytes = (std::size_t{4} << 30U) + static_cast<std::size_t>(tets) * 4096;
  const ChildOutcome outcome =
      run_in_child([&] { return mesh_to_bytes(static_cast<double>(tets), thickness); }, limits);
  const auto raw = from_bytes(answer(outcome, "mesh the board"));
  if (!raw) throw Error(1, "gmsh's answer is incomplete");
  return to_mesh(*raw, nullptr, "board", nullptr);
}

void convert_with_gmsh(const std::filesystem::path& from, const std::filesystem::path& to) {
  ChildLimits limits;
  limits.timeout = std::chrono::minutes(10);
  limits.memory_bytes = std::size_t{16} << 30U;
  const auto convert = [&]() -> std::string {
    try {
      gmsh::initialize(0, nullptr, false);
      gmsh::option::setNumber("General.Terminal", 1);
      gmsh::open(from.string());
      gmsh::write(to.string());
      return "M";
    } catch (const std::string& message) {
      return "E" + message;
    }
  };
  answer(run_in_child(convert, limits), "write " + to.string());
}

}  // namespace sunder::app
