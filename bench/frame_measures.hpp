// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sunder::bench {

/// Rows "measures/FIELD/TETRAHEDRA": what the largest strain and rotation of a frame cost beside
/// its stress pass, on one thread.
void register_measures();

}  // namespace sunder::bench
