// SPDX-License-Identifier: Apache-2.0
#include "board.hpp"

#include <algorithm>

namespace {

constexpr int kCells = 16, kRow = kCells + 1;
constexpr double kWidth = 50, kThickness = 2, kFrame = 5;  // mm
constexpr double kPull = -24;                              // mm
enum Material { kUpper, kLower, kStiff };

void add_material(sunder_scene scene, double young, double yield) {
  sunder_material material = SUNDER_MATERIAL_INIT;
  material.young = young;
  material.poisson = 0.4;
  material.yield = yield;  // 0: unbreakable
  check(sunder_scene_add_material(scene, &material, nullptr));
}

sunder_selection box(double x0, double y0, double x1, double y1) {
  sunder_selection s = SUNDER_SELECTION_INIT;
  s.kind = SUNDER_SELECT_BOX;
  s.min[0] = x0, s.min[1] = y0, s.min[2] = 0;
  s.max[0] = x1, s.max[1] = y1, s.max[2] = kThickness;
  return s;
}

void add_tools(sunder_scene scene) {
  sunder_support top = SUNDER_SUPPORT_INIT;
  top.nodes = box(0, kWidth, kWidth, kWidth);
  check(sunder_scene_add_support(scene, &top));
  sunder_instrument forceps = SUNDER_INSTRUMENT_INIT;
  forceps.name = "right forceps";
  forceps.nodes = box(kWidth, 0, kWidth, 0);
  forceps.kind = SUNDER_DISPLACEMENT;
  forceps.axes = SUNDER_AXIS_Y;
  forceps.value[1] = kPull;
  forceps.has_ramp = 1;
  forceps.ramp[1] = 0.75;
  check(sunder_scene_add_instrument(scene, &forceps, nullptr));
}

}  // namespace

Board::Board() {
  static constexpr int kCut[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                     {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int n = 0; n < 2 * kRow * kRow; ++n) {
    nodes.push_back(n % kRow * kWidth / kCells);
    nodes.push_back(n / kRow % kRow * kWidth / kCells);
    nodes.push_back(n / (kRow * kRow) * kThickness);
  }
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const int first = cell % kCells + cell / kCells * kRow;
    const double y = (cell / kCells + 0.5) * kWidth / kCells;
    const bool frame = y < kFrame || y > kWidth - kFrame;
    for (const auto& cut : kCut) {
      for (const int c : cut) {
        tets.push_back(first + c % 2 + c / 2 % 2 * kRow + c / 4 * kRow * kRow);
      }
      material_of.push_back(frame ? kStiff : y > kWidth / 2 ? kUpper : kLower);
    }
  }
  pulled_node = kRow * kRow + kCells;
}

sunder_scene make_scene(const Board& board, std::int32_t steps) {
  sunder_scene scene = nullptr;
  check(sunder_scene_create(&scene));
  check(sunder_scene_set_mesh(scene, board.nodes.data(), board.nodes.size(), board.tets.data(),
                              board.tets.size(), board.material_of.data(),
                              board.material_of.size()));
  add_material(scene, 5, 2);
  add_material(scene, 8, 4);
  add_material(scene, 500, 0);
  add_tools(scene);
  sunder_fracture_options fracture = SUNDER_FRACTURE_OPTIONS_INIT;
  // Model B takes the body for a flat board of even thickness. This one is: 50 x 50 x 2 mm. For any
  // other shape take SUNDER_FRACTURE_A (docs/limits.md).
  fracture.model = SUNDER_FRACTURE_B;
  fracture.birth = SUNDER_BIRTH_THROUGH;
  fracture.max_events = 1;  // so that the tear can be watched
  check(sunder_scene_set_fracture(scene, &fracture));
  check(sunder_scene_set_steps(scene, steps));
  return scene;
}
