// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sunder::bench {

/// Rows "assembly/TETRAHEDRA": the stiffness, beside Eigen's sum of a list of entries.
/// Rows "bases/TETRAHEDRA/UNKNOWNS/THREADS": what a new base of route condensed takes, part by
/// part.
void register_bases();

}  // namespace sunder::bench
