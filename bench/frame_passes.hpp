// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sunder::bench {

/// Rows "passes/LAW/TETRAHEDRA/THREADS": energy and internal forces at finite deformation, element
/// by element and eight at a time, and what stress and deformation cost besides.
void register_passes();

}  // namespace sunder::bench
