// SPDX-License-Identifier: Apache-2.0
// What docs/verification.md holds, section by section.
#pragma once

#include <ostream>

#include "core/field_sif/verification_cases.hpp"

namespace sunder::test {

void write_patch(std::ostream& out);
void write_cantilever(std::ostream& out);
void write_cook(std::ostream& out);
void write_pooled(std::ostream& out);
void write_peeling(std::ostream& out);
void write_calculix(std::ostream& out);

void write_strips(std::ostream& out, Notch notch);
void write_energy(std::ostream& out);
void write_domains(std::ostream& out);
void write_split(std::ostream& out);
void write_shaped(std::ostream& out);
void write_remaining_stiffness(std::ostream& out);
void write_irregular(std::ostream& out);

void write_angled(std::ostream& out);
void write_grown(std::ostream& out);
void write_force_pairs(std::ostream& out);
void write_thickness(std::ostream& out);
void write_antiplane(std::ostream& out);
void write_growing(std::ostream& out);
void write_first_growth(std::ostream& out);  ///< needs gmsh

// Numbers that the quick test computes again.

/// F = K / (s sqrt(pi a)) of a notched strip with h = W/n.
struct Factor {
  double value = 0, shear = 0;  ///< F, K_II/K_I
};
[[nodiscard]] Factor notch_factor(Notch notch, int n, double share,
                                  const CrackedBoardOptions& options = {});
/// K_I and K_II at `degrees` over s sqrt(pi a), the load turned.
struct Intensity {
  double k_1 = 0, k_2 = 0;
};
[[nodiscard]] Intensity angled_intensity(int degrees);
[[nodiscard]] double force_pair_intensity(double b);
[[nodiscard]] double antiplane_factor(int n, double share);

}  // namespace sunder::test
