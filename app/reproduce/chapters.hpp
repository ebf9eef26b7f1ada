// SPDX-License-Identifier: Apache-2.0
// The chapters of the study, one function each.
#pragma once

#include "app/reproduce/laboratory.hpp"
#include "app/reproduce/study.hpp"

namespace sunder::app::reproduce {

struct Effort {
  bool quick = false;  ///< fewer sizes, lengths and positions; the same experiments
};

/// One K of the two that drive the tips.
struct KChoice {
  std::string name;      ///< "formula K"
  std::string override;  ///< as --set
};
[[nodiscard]] const std::vector<KChoice>& both_k();

[[nodiscard]] Chapter pulled_board(const Laboratory& lab,
                                   const Effort& effort);    // experiment 1, Fig. 4, 5(a)
[[nodiscard]] Chapter notched_board(const Laboratory& lab);  // experiment 2, Fig. 5
[[nodiscard]] Chapter pressure_distance(const Laboratory& lab,
                                        const Effort& effort);  // experiment 3, Fig. 6
[[nodiscard]] Chapter pressure_side(const Laboratory& lab);     // experiment 4, Fig. 7
[[nodiscard]] Chapter paper_times(const Laboratory& lab);       // experiment 5, Tables 2 and 3
[[nodiscard]] Chapter several_cracks(const Laboratory& lab);
[[nodiscard]] Chapter k_along_crack(const Laboratory& lab);
[[nodiscard]] Chapter mesh_study(const Laboratory& lab, const Effort& effort);
[[nodiscard]] Chapter notch_length(const Laboratory& lab, const Effort& effort);
[[nodiscard]] Chapter pressure_position(const Laboratory& lab, const Effort& effort);
[[nodiscard]] Chapter pressure_angle(const Laboratory& lab, const Effort& effort);
[[nodiscard]] Chapter two_laws(const Laboratory& lab, const Effort& effort);

}  // namespace sunder::app::reproduce
