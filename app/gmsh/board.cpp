// SPDX-License-Identifier: Apache-2.0
#include "app/gmsh/board.hpp"

#include <gmsh.h>

#include <cmath>

#include "app/mesh_board/structured_board.hpp"

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

}  // namespace

void mesh_board(double tets, double thickness) {
  gmsh::option::setNumber("Mesh.RandomSeed", 1);
  gmsh::option::setNumber("Mesh.Algorithm", 5);    // Delaunay in the plane ...
  gmsh::option::setNumber("Mesh.Algorithm3D", 1);  // ... and in space
  gmsh::option::setNumber("Mesh.CharacteristicLengthExtendFromBoundary", 0);
  reach_count(tets, thickness);
}

}  // namespace sunder::app
