// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sunder::bench {

/// Rows "frame_cascade/ROUTE/TETRAHEDRA": 640 fractures, one a frame and without a pause, by the
/// library's own backend with its thread beside it. Where the first frames, the median ones, the
/// slowest hundredth and the last ones spend their time.
void register_cascades();

}  // namespace sunder::bench
