/* SPDX-License-Identifier: Apache-2.0 */
/* What Live.cs --sizes must print. */
#include <stdio.h>
#include <sunder/sunder.h>

int main(void) {
  printf("Selection %zu\nMaterial %zu\nSupport %zu\nInstrument %zu\nFracture %zu\nSolver %zu\n",
         sizeof(sunder_selection), sizeof(sunder_material), sizeof(sunder_support),
         sizeof(sunder_instrument), sizeof(sunder_fracture_options), sizeof(sunder_solver_options));
  printf("Surface %zu\nFrame %zu\nTriangle %zu\nHand %zu\nFelt %zu\n", sizeof(sunder_surface),
         sizeof(sunder_frame), sizeof(sunder_triangle), sizeof(sunder_hand), sizeof(sunder_felt));
  printf("Rupture %zu\nInterface %zu\nBody %zu\n", sizeof(sunder_event), sizeof(sunder_interface),
         sizeof(sunder_body));
  return 0;
}
