// SPDX-License-Identifier: Apache-2.0
// A live body: a forceps takes hold of a board, turns and pulls until it tears, lets go; a blade
// cuts it; all of it is undone.   cc live.c $(pkg-config --cflags --libs sunder)
#include <math.h>
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
  sunder_fracture_options fracture = SUNDER_FRACTURE_OPTIONS_INIT;
  fracture.model = SUNDER_FRACTURE_A;
  CHECK(sunder_scene_set_fracture(scene, &fracture));
  CHECK(sunder_scene_set_live(scene, 1));           // a host may grasp, remove and cut
  CHECK(sunder_scene_set_steps(scene, INT32_MAX));  // until the host stops

  sunder_simulation simulation;
  CHECK(sunder_simulation_create(scene, NULL, &simulation));
  CHECK(sunder_scene_destroy(scene));
  CHECK(sunder_simulation_keep_history(simulation, 100));
  int32_t begin = 0;
  CHECK(sunder_simulation_save(simulation, &begin));
  CHECK(sunder_simulation_step(simulation, NULL));

  // All nodes within 1.2 mm of the lower right corner, as one solid.
  const double corner[3] = {10, 0, 0.5};
  int32_t grip = 0;
  CHECK(sunder_simulation_grasp_near(simulation, corner, 1.2, 1, &grip));
  sunder_step step = SUNDER_STEP_INIT;
  double force[3], torque[3];
  for (int i = 1; step.events == 0; ++i) {
    const double angle = 0.01 * i;  // about z [rad]
    const double place[3] = {10, -0.1 * i, 0.5};
    const double turn[4] = {0, 0, sin(angle / 2), cos(angle / 2)};
    CHECK(sunder_simulation_pose(simulation, grip, place, turn));
    CHECK(sunder_simulation_step(simulation, &step));
    CHECK(sunder_simulation_wrench(simulation, grip, force, torque));
    printf("%.1f mm down: %6.3f N, %6.3f N mm, %d destroyed\n", -place[1], -force[1], torque[2],
           step.destroyed);
  }
  CHECK(sunder_simulation_release(simulation, grip));
  CHECK(sunder_simulation_step(simulation, &step));
  const int torn = step.destroyed;

  // A blade of 4 mm into the left edge: its edge, from a to b, has gone to c and d.
  const double a[3] = {-1, 5.5, -1}, b[3] = {-1, 5.5, 2}, c[3] = {4, 5.5, -1}, d[3] = {4, 5.5, 2};
  const double swept[18] = {a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2],
                            b[0], b[1], b[2], d[0], d[1], d[2], c[0], c[1], c[2]};
  int32_t removed = 0, undone = 0;
  CHECK(sunder_simulation_cut(simulation, swept, 18, &removed));
  CHECK(sunder_simulation_step(simulation, &step));
  printf("torn: %d elements, cut: %d\n", torn, (int)removed);

  CHECK(sunder_simulation_undo(simulation, 1, &undone, NULL));  // the cut
  CHECK(sunder_simulation_step(simulation, &step));
  if (step.destroyed != torn) return fprintf(stderr, "the cut is still there\n"), 1;
  CHECK(sunder_simulation_restore(simulation, begin, NULL));  // all of it
  CHECK(sunder_simulation_step(simulation, &step));
  printf("undone: %d destroyed\n", step.destroyed);
  CHECK(sunder_simulation_destroy(simulation));
  return step.destroyed;
}
