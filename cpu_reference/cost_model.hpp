// SPDX-License-Identifier: Apache-2.0
// What a frame will take, from the values that it reads and the columns that an update carries
// through the factor. For `plan`: right to a small factor, and in the right order between routes.
#pragma once

#include <cstddef>

#include "linear_algebra/supernodal_cholesky.hpp"
#include "sunder/problem.hpp"

namespace sunder::cpu_reference {

struct FrameShape {
  Route route = Route::inverse;
  bool eager = false;
  bool damage = false;        ///< something can be destroyed
  std::size_t unknowns = 0;   ///< of the body
  std::size_t kept = 0;       ///< rows of the dense inverse: all, or those of a condensed region
  std::size_t loaded = 0;     ///< unknowns with a force or a grip
  std::size_t entries = 0;    ///< of the factor L; 0: conjugate gradients do without
  std::size_t path = 0;       ///< of them on the elimination path of one element
  std::size_t load_path = 0;  ///< of them on the elimination path of the loaded unknowns
  std::size_t elements = 0;   ///< of the body
  std::size_t stressed = 0;   ///< elements whose stress a frame computes
  std::size_t threads = 1;    ///< that share the stress
};

struct FrameCost {
  double quiet_ms = 0;
  double fracture_ms = 0;  ///< 0: nothing can be destroyed
};

[[nodiscard]] FrameCost frame_cost(const FrameShape& shape);

/// Frames that follow one another without a pause while another thread makes a factor of the
/// damaged body, checks it and follows them. From sizes alone: what is taken after so many frames
/// must not depend on how long anything took.
[[nodiscard]] int frames_of_a_factor(const linear_algebra::SupernodalCholesky& factor,
                                     std::size_t elements);

/// Whether an event of so many elements is worth a new factor of the body instead of an update.
[[nodiscard]] bool takes_new_factor(std::size_t unknowns, std::size_t elements);

}  // namespace sunder::cpu_reference
