// SPDX-License-Identifier: Apache-2.0
// From arrays to a torn board: C99, one header, one library.   cc hello.c $(pkg-config --cflags
// --libs sunder)
#include <stdio.h>
#include <stdlib.h>
#include <sunder/sunder.h>

#define CHECK(call) \
  if ((call) != SUNDER_OK) return fprintf(stderr, "%s: %s\n", #call, sunder_last_error()), 1

enum { kCells = 10, kRow = kCells + 1, kNodes = 2 * kRow * kRow, kTets = 6 * kCells * kCells };
static double nodes[kNodes][3];  // mm
static int32_t tets[kTets][4];

// 10 x 10 x 1 mm: one layer of cubes, each cut into six tetrahedra round its diagonal 0-7.
static void make_board(void) {
  static const int cut[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int n = 0; n < kNodes; ++n) {
    nodes[n][0] = n % kRow, nodes[n][1] = n / kRow % kRow, nodes[n][2] = n / (kRow * kRow);
  }
  for (int t = 0; t < kTets; ++t) {
    const int first = t / 6 % kCells + t / 6 / kCells * kRow;
    for (int k = 0; k < 4; ++k) {
      const int c = cut[t % 6][k];  // corner of the cube: x + 2 y + 4 z
      tets[t][k] = first + c % 2 + c / 2 % 2 * kRow + c / 4 * kRow * kRow;
    }
  }
}

int main(void) {
  make_board();
  sunder_scene scene;
  CHECK(sunder_scene_create(&scene));
  CHECK(sunder_scene_set_mesh(scene, nodes[0], 3 * kNodes, tets[0], 4 * kTets, NULL, 0));
  sunder_material tissue = SUNDER_MATERIAL_INIT;
  tissue.young = 5, tissue.poisson = 0.4, tissue.yield = 2;  // MPa
  CHECK(sunder_scene_add_material(scene, &tissue, NULL));
  sunder_support top = SUNDER_SUPPORT_INIT;
  top.nodes = (sunder_selection){.kind = SUNDER_SELECT_BOX, .min = {0, 10, 0}, .max = {10, 10, 1}};
  CHECK(sunder_scene_add_support(scene, &top));
  sunder_instrument forceps = SUNDER_INSTRUMENT_INIT;
  forceps.nodes =
      (sunder_selection){.kind = SUNDER_SELECT_BOX, .min = {10, 0, 0}, .max = {10, 0, 1}};
  forceps.value[1] = -2.4;  // N, growing from step to step
  forceps.has_ramp = 1, forceps.ramp[1] = 1;
  CHECK(sunder_scene_add_instrument(scene, &forceps, NULL));
  sunder_fracture_options fracture = SUNDER_FRACTURE_OPTIONS_INIT;
  // Model B takes the body for a flat board of even thickness. This one is: 10 x 10 x 1 mm. For any
  // other shape take SUNDER_FRACTURE_A (docs/limits.md).
  fracture.model = SUNDER_FRACTURE_B;
  CHECK(sunder_scene_set_fracture(scene, &fracture));
  CHECK(sunder_scene_set_steps(scene, 20));

  sunder_simulation simulation;
  CHECK(sunder_simulation_create(scene, NULL, &simulation));
  sunder_step step = SUNDER_STEP_INIT;
  for (int i = 0; i < 20; ++i) {
    CHECK(sunder_simulation_step(simulation, &step));
    printf("step %2d: %.2f N, %2d destroyed, %.3f ms\n", step.step, 2.4 * step.load_factor,
           step.destroyed, step.ms_total);
  }
  sunder_event event = SUNDER_EVENT_INIT;
  CHECK(sunder_simulation_event_at(simulation, 0, &event));
  printf("element %d broke first: %.2f times its yield stress\n", event.element, event.ratio);
  CHECK(sunder_simulation_destroy(simulation));
  CHECK(sunder_scene_destroy(scene));
  return 0;
}
