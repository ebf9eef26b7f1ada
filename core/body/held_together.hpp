// SPDX-License-Identifier: Apache-2.0
// Whether a changed body can move without strain: a piece that is cut off, hangs on a node or turns
// about an edge. That is a matter of where elements meet, whatever their stiffness: the matrix
// alone shows it only as far as its rounding lets it.
#pragma once

#include "body/change.hpp"

namespace sunder::fem {

/// Every element with a share of its stiffness counts, alpha too. Elements joined by faces move as
/// one rigid piece; nodes that pieces share and supports (not grips) must leave no motion. Also
/// false where an unknown of the mesh has no element any more. Sorts all faces of the body.
[[nodiscard]] bool held_together(const Forms& forms);
/// The same after a change; what leaves keeps alpha, which holds it.
[[nodiscard]] bool holds_together(const Forms& forms, const Event& change);

}  // namespace sunder::fem
